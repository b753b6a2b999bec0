// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/read_only.hpp>
#include <clearance/points/point_filter.hpp>
#include <clearance/points/survey_floats.hpp>

namespace clearance {

/// `count` points, each three floats x y z, one after another (12 bytes per point). Metres.
struct point_span {
  const vec3* points = nullptr;
  std::size_t count = 0;
  point_filter filter = {};
  position_error off = {};  ///< The error of the floats, if they were made from something finer.

  point_span() = default;
  point_span(const vec3* points, std::size_t count, point_filter filter = {})
      : points(points), count(count), filter(filter) {}
  point_span(std::span<const vec3> s, point_filter filter = {}) : point_span(s.data(), s.size(), filter) {}
  point_span(const std::vector<vec3>& v, point_filter filter = {}) : point_span(v.data(), v.size(), filter) {}

  CLEARANCE_HD std::size_t size() const { return count; }
  CLEARANCE_HD sample operator[](std::size_t i) const { return filter(points[i]); }

  /// Four points as they lie in memory; see `fetched_source`.
  struct alignas(16) four {
    real f[12];
  };
  CLEARANCE_HD bool fetches() const { return reinterpret_cast<std::uintptr_t>(points) % 16 == 0; }
  using cursor = const four*;
  CLEARANCE_HD cursor seek(std::size_t i) const { return reinterpret_cast<const four*>(points) + i / 4; }
  CLEARANCE_HD cursor skip(cursor c, std::size_t n) const { return c + n / 4; }
  CLEARANCE_HD four fetch(cursor c) const { return read_only(c); }
  CLEARANCE_HD unsigned look(const four& r, std::size_t, vec3 (&out)[4]) const { return filter.look(r.f, out); }

  CLEARANCE_HD bool unfiltered() const { return filter.plain(); }
  /// See `surveyed_source`.
  bool survey(std::size_t begin, extent& box, std::uint32_t (&dropped)[drop_reasons]) const {
    if (!unfiltered()) return false;
    const detail::surveyed seen = detail::survey(&points[begin].x);
    box = seen.box;
    dropped[int(drop_reason::not_finite)] += seen.not_finite;
    return true;
  }
  CLEARANCE_HD point_span slice(std::size_t begin, std::size_t end) const {
    point_span some = *this;
    some.points += begin, some.count = end - begin;
    return some;
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

static_assert(fetched_source<point_span> && surveyed_source<point_span> && unfiltered_source<point_span>);

}  // namespace clearance
