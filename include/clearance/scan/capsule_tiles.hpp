// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How the host reads a source whose points stand for capsules: tile by tile, as points.

#include <clearance/frame/root_test.hpp>
#include <clearance/ground/vectors.hpp>
#include <clearance/points/extremes.hpp>
#include <clearance/scan/drops.hpp>
#include <clearance/scan/element.hpp>
#include <clearance/scan/tile.hpp>

#include <algorithm>

namespace clearance::scan {

/// Room that contains capsules: their starts are in one box, their ends in the other, and they are at most so wide.
struct capsule_hull {
  extent starts, ends;
  real wide = 0;

  bool empty() const { return !(starts.lower.x <= starts.upper.x); }
  /// Less an origin.
  void subtract(vec3 origin) {
    if (origin == vec3{0, 0, 0}) return;
    for (extent* box : {&starts, &ends}) box->lower = box->lower - origin, box->upper = box->upper - origin;
  }
  /// May any of them touch a box? There must be a share of the way at which the box between starts and ends overlaps it
  /// along every axis. Up to rounding.
  bool may_touch(const extent& box, real beside) const {
    real low = 0, high = 1;
    const auto keep = [&](real at_start, real at_end) {  // shares at which at_start + share (at_end - at_start) >= 0
      constexpr real more = 8 * slack;
      if (at_start < 0) at_end >= 0 ? low = std::max(low, at_start / (at_start - at_end) - more) : high = -1;
      if (at_start >= 0 && at_end < 0) high = std::min(high, at_start / (at_start - at_end) + more);
    };
    const auto axis = [&](real lower, real upper, real sl, real su, real el, real eu) {
      const real off = beside + slack * (absolute(lower) + absolute(upper) + absolute(sl) + absolute(su) +
                                         absolute(el) + absolute(eu));
      keep(upper + off - sl, upper + off - el), keep(su - lower + off, eu - lower + off);
    };
    axis(box.lower.x, box.upper.x, starts.lower.x, starts.upper.x, ends.lower.x, ends.upper.x);
    axis(box.lower.y, box.upper.y, starts.lower.y, starts.upper.y, ends.lower.y, ends.upper.y);
    axis(box.lower.z, box.upper.z, starts.lower.z, starts.upper.z, ends.lower.z, ends.upper.z);
    return low <= high;
  }
  bool may_reach(const ball& around, real reach) const {
    const real most = frames::limit(around, reach + wide);
    const vec3 c = around.center, r{most, most, most};
    return most >= 0 && !behind(c, most) && may_touch({c - r, c + r}, 0);
  }
  /// Do all begin so far from a place and lead away from it? A plane between it and both boxes says so. Up to rounding.
  bool behind(vec3 c, real most) const {
    using clearance::detail::size_of;
    const auto beyond = [](real low, real high, real at) { return low > at ? low - at : high < at ? high - at : 0; };
    const vec3 way{beyond(starts.lower.x, starts.upper.x, c.x), beyond(starts.lower.y, starts.upper.y, c.y),
                   beyond(starts.lower.z, starts.upper.z, c.z)};
    const auto nearest = [](real along, real low, real high) { return along * (along > 0 ? low : high); };
    const auto away = [&](const extent& box) {
      return nearest(way.x, box.lower.x - c.x, box.upper.x - c.x) +
             nearest(way.y, box.lower.y - c.y, box.upper.y - c.y) +
             nearest(way.z, box.lower.z - c.z, box.upper.z - c.z);
    };
    const real square = dot(way, way), least = min(square, away(ends));
    const real limit = most + 8 * slack * (size_of(c) + size_of(ends.lower) + size_of(ends.upper));
    return least > 0 && least * least > limit * limit * square;
  }
};

/// A source that says where the capsules of 128 neighbours are, without taking them apart; see `surveyed_source`.
/// Law: if it is true, starts and ends are in those boxes, and no radius is above `widest`.
template <class S>
concept surveyed_capsules = capsule_source<S> && requires(const S s, std::size_t begin, extent& box, real& widest,
                                                          std::uint32_t (&dropped)[drop_reasons]) {
  { s.survey_capsules(begin, box, box, widest, dropped) } -> std::same_as<bool>;
};

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
  capsule_hull hull() const {
    capsule_hull all{starts_.box(), ends_.box()};
    for (std::size_t j = 0; j < points; ++j) all.wide = wide_[j] > all.wide ? wide_[j] : all.wide;
    return all;
  }
  vec3 start(std::size_t j) const { return starts_[j]; }

  /// Marks those that may be within reach of a ball.
  void mark(const ball& around, real reach, std::uint32_t bit, std::uint32_t* near) const {
    const real most = reach + around.radius;
    const vec3 c = around.center;
    for (std::size_t j = 0; j < points; ++j) {
      const real x = c.x - starts_.x[j], y = c.y - starts_.y[j], z = c.z - starts_.z[j];
      const real share = (x * along_.x[j] + y * along_.y[j] + z * along_.z[j]) * inverse_[j];
      const real t = min(max(share, 0), 1);
      const real dx = x - t * along_.x[j], dy = y - t * along_.y[j], dz = z - t * along_.z[j];
      const real limit = (most + wide_[j]) * (1 + 4 * slack);
      near[j] |= bool(int(limit >= 0) & int(dx * dx + dy * dy + dz * dz <= limit * limit)) ? bit : 0;
    }
  }

 private:
  struct places {
    alignas(64) real x[points], y[points], z[points];

    void put(std::size_t j, vec3 p) { x[j] = p.x, y[j] = p.y, z[j] = p.z; }
    vec3 operator[](std::size_t j) const { return {x[j], y[j], z[j]}; }
    extent box() const {
      extent b;
      spread(x, b.lower.x, b.upper.x), spread(y, b.lower.y, b.upper.y), spread(z, b.lower.z, b.upper.z);
      return b;
    }
  };

  places starts_, ends_, along_;
  alignas(64) real inverse_[points], wide_[points];
};

/// Tests points begin .. end - 1 of a source whose points stand for capsules. `near`: a box around all that is within
/// reach of some part. `survivors`: those of a tile.
template <class Survivors, class Body>
void scan_capsules(const Body& body, std::size_t begin, std::size_t end, const extent& near, drop_tally& mine) {
  for (std::size_t i = begin; i < end; i += capsule_tile::points) {
    capsule_hull hull;
    const auto counted = [&] {
      if constexpr (surveyed_capsules<decltype(body.source)>)
        return i + capsule_tile::points <= end &&
               body.source.survey_capsules(i, hull.starts, hull.ends, hull.wide, mine.dropped);
      return false;
    }();
    const auto may_reach_some = [&] {
      for (std::uint32_t k = 0; k < body.part_count; ++k)
        if (hull.may_reach(body.places[k].around, body.answer.reach(k))) return true;
      return false;
    };
    hull.subtract(body.origin);
    // The box knows no part whose reach is below minus its size.
    const bool beside = hull.wide == 0 && !hull.may_touch(near, 0);
    if (counted && (hull.empty() || beside || !may_reach_some())) continue;
    tile points;  // read apart: in vector code a product in a position may be fused with what follows
    drop_tally again;
    points.load(body.source, i, std::min(capsule_tile::points, end - i), 1, counted ? again : mine);
    points.subtract(body.origin);
    capsule_tile t;
    with_vectors([&] {
      for (std::size_t j = 0; j < capsule_tile::points; ++j)
        t.put(j, points.x[j] == points.x[j] ? body.element(points[j], i + j) : capsule{points[j], {0, 0, 0}, 0});
      hull = t.hull();
    });
    Survivors those;
    bool any = false;
    for (std::uint32_t k = 0; k < body.part_count; ++k)
      if (const ball& around = body.places[k].around; hull.may_reach(around, body.answer.reach(k)))
        any = true, those.add(t, around, body.answer.reach(k), k);
    if (any)
      with_vectors(
          [&] { those.for_each([&](std::size_t j, std::uint32_t parts) { body.visit(t.start(j), i + j, parts); }); });
  }
}

}  // namespace clearance::scan
