// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud in an array, three floats for each point.

#include <clearance/ground/borrowed.hpp>
#include <clearance/ground/read_only.hpp>
#include <clearance/points/extremes.hpp>
#include <clearance/points/point_filter.hpp>

namespace clearance::detail {

// The box of 128 points in one array, and how many of them are invalid.

/// The box around many points, x y z one after another, without separating the coordinates.
inline extent box_of(const real* f) {
  constexpr std::size_t lanes = 24;
  extremes<lanes> all;
  for (std::size_t i = 0; i < 3 * surveyed_points; i += lanes) all.add(f + i);
  for (std::size_t j = 0; j < lanes / 2; ++j) {
    all.low[j] = min(all.low[j], all.low[j + lanes / 2]);
    all.high[j] = max(all.high[j], all.high[j + lanes / 2]);
  }
  extent box;
  for (std::size_t j = 0; j < lanes / 2; j += 3) {
    box.lower = {min(box.lower.x, all.low[j]), min(box.lower.y, all.low[j + 1]), min(box.lower.z, all.low[j + 2])};
    box.upper = {max(box.upper.x, all.high[j]), max(box.upper.y, all.high[j + 1]), max(box.upper.z, all.high[j + 2])};
  }
  return box;
}

/// Is every number finite? Also false if only their sum is not.
inline bool sum_is_finite(const real* f) {
  constexpr std::size_t lanes = 16;
  alignas(64) real sums[lanes] = {};
  for (std::size_t i = 0; i < 3 * surveyed_points; i += lanes)
    for (std::size_t j = 0; j < lanes; ++j) sums[j] += f[i + j];
  for (std::size_t half = lanes / 2; half >= 4; half /= 2)
    for (std::size_t j = 0; j < half; ++j) sums[j] += sums[j + half];
  const real sum = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  return sum - sum == 0;
}

/// Counts points with a coordinate that is not finite.
inline std::uint32_t count_not_finite(const real* f) {
  std::uint32_t found = 0;
  for (std::size_t i = 0; i < 3 * surveyed_points; i += 3)  // as is_finite, without branches
    found += !(int(std::abs(f[i]) <= 1e18f) & int(std::abs(f[i + 1]) <= 1e18f) & int(std::abs(f[i + 2]) <= 1e18f));
  return found;
}

struct surveyed {
  extent box;
  std::uint32_t not_finite;
};
/// Prefetches what will be surveyed soon: otherwise the work on a tile would begin with a wait for memory. Prefetching
/// beyond the array does nothing.
inline void ask_ahead(const real* f) {
  constexpr std::size_t tile = 3 * surveyed_points * sizeof(real), tiles = 4, line = 64;
  const auto ahead = reinterpret_cast<std::uintptr_t>(f) + tiles * tile;
  for (std::size_t i = 0; i < tile; i += line) __builtin_prefetch(reinterpret_cast<const void*>(ahead + i));
}
inline surveyed survey_here(const real* f) {
  ask_ahead(f);
  const extent box = box_of(f);
  if (sum_is_finite(f) && is_finite(box.lower) && is_finite(box.upper)) return {box, 0};
  return {box, box.lower.x > box.upper.x ? std::uint32_t(surveyed_points) : count_not_finite(f)};
}
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__AVX2__)
/// Twice as wide if the processor can, without a compiler flag. Boxes and counts are the same.
__attribute__((target("avx2"), flatten)) inline surveyed survey_avx2(const real* f) { return survey_here(f); }
inline surveyed survey(const real* f) { return __builtin_cpu_supports("avx2") ? survey_avx2(f) : survey_here(f); }
#else
inline surveyed survey(const real* f) { return survey_here(f); }
#endif

}  // namespace clearance::detail

namespace clearance {

/// `count` points, each three floats x y z, one after another (12 bytes per point). Metres.
struct point_span {
  using can = clearance::can<sources::fetched, sources::surveyed, sources::unfiltered, sources::filtered,
                             sources::slicing, sources::copied, sources::checked, sources::rounded>;

  const vec3* points = nullptr;
  std::size_t count = 0;
  point_filter filter = {};
  position_error off = {};  ///< The error of the floats, if they were made from something finer.

  point_span() = default;
  point_span(const vec3* points, std::size_t count, point_filter filter = {})
      : points(points), count(count), filter(filter) {}
  point_span(std::span<const vec3> s, point_filter filter = {}) : point_span(s.data(), s.size(), filter) {}
  point_span(const std::vector<vec3>& v CLEARANCE_LIFETIMEBOUND, point_filter filter = {})
      : point_span(v.data(), v.size(), filter) {}
  template <owning_range R>
  point_span(const R&&, point_filter = {}) = delete;  // the points would be gone before they are read; name them

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
    some.points += begin;
    some.count = end - begin;
    return some;
  }

  /// The memory it reads, and the same view of a copy elsewhere.
  std::span<const std::byte> bytes() const { return std::as_bytes(std::span(points, count)); }
  point_span at(const std::byte* copy) const {
    point_span moved = *this;
    moved.points = reinterpret_cast<const vec3*>(copy);
    return moved;
  }
  /// See `rounding_of`.
  void check() const {
    filter.check();
    if (points == nullptr && count != 0)
      detail::refuse_source("a cloud of " + std::to_string(count) + " points has none: they are null");
  }
  position_error rounding() const { return off; }
};

static_assert(fetched_source<point_span> && surveyed_source<point_span> && unfiltered_source<point_span>);

}  // namespace clearance
