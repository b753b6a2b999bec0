// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/point_filter.hpp>

namespace clearance {

/// `count` times three floats, x y z, one after another (12 bytes a point).
struct point_span {
  const vec3* points = nullptr;
  std::size_t count = 0;
  point_filter filter = {};
  position_error off = {};  ///< What the floats have lost, if they were made from something finer.

  point_span() = default;
  point_span(const vec3* points, std::size_t count, point_filter filter = {}) : points(points), count(count), filter(filter) {}
  point_span(std::span<const vec3> s, point_filter filter = {}) : point_span(s.data(), s.size(), filter) {}
  point_span(const std::vector<vec3>& v, point_filter filter = {}) : point_span(v.data(), v.size(), filter) {}

  CLEARANCE_HD std::size_t size() const { return count; }
  CLEARANCE_HD sample operator[](std::size_t i) const { return filter(points[i]); }

  /// Four points as they lie in memory, which a kernel may fetch before it looks at them: an array of these, or null.
  struct alignas(16) raw4 {
    real f[12];
  };
  CLEARANCE_HD const raw4* fours() const { return reinterpret_cast<std::uintptr_t>(points) % 16 == 0 ? reinterpret_cast<const raw4*>(points) : nullptr; }
  CLEARANCE_HD void look4(const raw4& r, std::size_t, sample (&out)[4]) const {
    const auto point = [&](int j) { return vec3{r.f[3 * j], r.f[3 * j + 1], r.f[3 * j + 2]}; };
    if (filter.plain()) {
      CLEARANCE_UNROLL
      for (int j = 0; j < 4; ++j) out[j] = {point(j), is_finite(point(j)) ? drop_reason::none : drop_reason::not_finite};
    } else {
      CLEARANCE_UNROLL
      for (int j = 0; j < 4; ++j) out[j] = filter(point(j));
    }
  }

  /// As `look4`, but in few instructions: where they are, and why they do not count, a byte each; or ~0: ask `look4`.
  CLEARANCE_HD unsigned positions4(const raw4& r, std::size_t, vec3 (&out)[4]) const {
    bool told = filter.plain();
    unsigned reasons = 0;
    CLEARANCE_UNROLL
    for (int j = 0; j < 4; ++j) {
      out[j] = {r.f[3 * j], r.f[3 * j + 1], r.f[3 * j + 2]};
      const real square = dot(out[j], out[j]);  // a kernel needs it, too; NaN if a coordinate is
      told &= !(square >= 0x1p116f);            // all are finite
      reasons |= unsigned(square == square ? drop_reason::none : drop_reason::not_finite) << 8 * j;
    }
    return told ? reasons : ~0u;
  }

  /// The memory it reads, and the same view of a copy elsewhere.
  std::span<const std::byte> bytes() const { return std::as_bytes(std::span(points, count)); }
  point_span at(const std::byte* copy) const {
    point_span moved = *this;
    moved.points = reinterpret_cast<const vec3*>(copy);
    return moved;
  }
  position_error rounding() const { return off; }
};

static_assert(point_source<point_span>);

}  // namespace clearance
