// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How the host reads a source whose points stand for capsules: tile by tile, as points.

#include <clearance/frame/root_test.hpp>
#include <clearance/points/extremes.hpp>
#include <clearance/scan/drops.hpp>
#include <clearance/scan/element.hpp>

#include <algorithm>

namespace clearance::scan {

/// The capsules of a tile, less the search's origin. That of an invalid point is NaN and fails every comparison.
class capsule_tile {
 public:
  static constexpr std::size_t points = surveyed_points;

  void put(std::size_t j, const capsule& c) {
    const real square = dot(c.along, c.along);
    starts_.put(j, c.from), ends_.put(j, c.at(1)), along_.put(j, c.along);
    inverse_[j] = square > 0 ? 1 / square : 0;
    wide_[j] = c.radius + detail::noise_along(c);
  }
  /// Call it after all are put.
  void enclose() {
    starts_.enclose(), ends_.enclose();
    widest_ = 0;
    for (std::size_t j = 0; j < points; ++j) widest_ = wide_[j] > widest_ ? wide_[j] : widest_;
  }
  vec3 start(std::size_t j) const { return starts_[j]; }

  /// May any of them be within reach of a ball? All are between two boxes, the starts' and the ends'. So there must be
  /// a share of the way at which the box between those is near along every axis.
  bool may_reach(const ball& around, real reach) const {
    const real most = frames::limit(around, reach + widest_) * (1 + 4 * slack);
    if (!(most >= 0)) return false;
    real low = 0, high = 1;
    const auto keep = [&](real at_start, real at_end) {  // the share at which start + share (end - start) >= 0
      const real rise = at_end - at_start, roots = 8 * slack;
      if (at_start < 0 && !(at_end >= 0)) high = -1;
      if (at_start < 0 && at_end >= 0) low = std::max(low, -at_start / rise - roots);
      if (at_start >= 0 && at_end < 0) high = std::min(high, -at_start / rise + roots);
    };
    const auto axis = [&](real c, real sl, real su, real el, real eu) {
      const real off = slack * (absolute(c) + absolute(sl) + absolute(su) + absolute(el) + absolute(eu));
      keep(c + most + off - sl, c + most + off - el), keep(su - c + most + off, eu - c + most + off);
    };
    const vec3 c = around.center;
    const extent &s = starts_.box, &e = ends_.box;
    axis(c.x, s.lower.x, s.upper.x, e.lower.x, e.upper.x);
    axis(c.y, s.lower.y, s.upper.y, e.lower.y, e.upper.y);
    axis(c.z, s.lower.z, s.upper.z, e.lower.z, e.upper.z);
    return low <= high;
  }

  /// Marks those that may be within reach of a ball.
  void mark(const ball& around, real reach, std::uint32_t* near) const {
    const real most = reach + around.radius;
    const vec3 c = around.center;
    for (std::size_t j = 0; j < points; ++j) {
      const real x = c.x - starts_.x[j], y = c.y - starts_.y[j], z = c.z - starts_.z[j];
      const real share = (x * along_.x[j] + y * along_.y[j] + z * along_.z[j]) * inverse_[j];
      const real t = min(max(share, 0), 1);
      const real dx = x - t * along_.x[j], dy = y - t * along_.y[j], dz = z - t * along_.z[j];
      const real limit = (most + wide_[j]) * (1 + 4 * slack);
      near[j] |= std::uint32_t(int(limit >= 0) & int(dx * dx + dy * dy + dz * dz <= limit * limit));
    }
  }

 private:
  struct places {
    alignas(64) real x[points], y[points], z[points];
    extent box;

    void put(std::size_t j, vec3 p) { x[j] = p.x, y[j] = p.y, z[j] = p.z; }
    vec3 operator[](std::size_t j) const { return {x[j], y[j], z[j]}; }
    void enclose() {
      spread(x, box.lower.x, box.upper.x), spread(y, box.lower.y, box.upper.y), spread(z, box.lower.z, box.upper.z);
    }
  };

  places starts_, ends_, along_;
  alignas(64) real inverse_[points], wide_[points];
  real widest_ = 0;
};

}  // namespace clearance::scan
