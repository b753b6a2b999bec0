// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The host's way to read a cloud: first only where a hundred points are together, in loops that compilers turn into
// vector code on every processor; their coordinates one by one only if a part may be near.

#include <clearance/points/depth_image.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/search/tally.hpp>

namespace clearance::search {

inline constexpr std::size_t tile_points = 128;

/// A box around the valid points of a tile, perhaps too large; empty (lower > upper) if there is none.
struct tile_box {
  vec3 lower = {infinity, infinity, infinity}, upper = {-infinity, -infinity, -infinity};
};

/// The points of a tile, less the search's origin. What is no point is NaN and fails every comparison.
struct tile {
  alignas(64) real x[tile_points], y[tile_points], z[tile_points];

  void put(std::size_t j, vec3 p) { x[j] = p.x, y[j] = p.y, z[j] = p.z; }
  vec3 operator[](std::size_t j) const { return {x[j], y[j], z[j]}; }

  /// Points begin, begin + stride, ..., `count` of them; what is dropped is counted. The source is a copy, which no
  /// write here can change, and is read in this loop alone, so that compilers take it apart.
  template <point_source S>
  [[gnu::flatten]] void load(const S source, std::size_t begin, std::size_t count, std::size_t stride, tally& mine) {
    constexpr vec3 nowhere{not_a_number, not_a_number, not_a_number};
    for (std::size_t j = count; j < tile_points; ++j) put(j, nowhere);
    if constexpr (requires { source.filter.plain(); }) {
      if (source.filter.plain()) {  // only finiteness is asked, and in vectors
        for (std::size_t j = 0; j < count; ++j) put(j, source[begin + j * stride].position);
        mine.dropped[int(drop_reason::not_finite)] += drop_not_finite() - std::uint32_t(tile_points - count);
        return;
      }
    }
    for (std::size_t j = 0; j < count; ++j) {
      const sample s = source[begin + j * stride];
      if (!s.valid()) ++mine.dropped[int(s.dropped)];
      put(j, s.valid() ? s.position : nowhere);
    }
  }
  void subtract(vec3 origin) {
    if (origin == vec3{0, 0, 0}) return;
    for (std::size_t j = 0; j < tile_points; ++j) x[j] -= origin.x, y[j] -= origin.y, z[j] -= origin.z;
  }

 private:
  std::uint32_t drop_not_finite() {
    std::uint32_t bad = 0;
    for (std::size_t j = 0; j < tile_points; ++j) {
      // As is_finite, without branches.
      const bool good = int(std::abs(x[j]) <= 1e18f) & int(std::abs(y[j]) <= 1e18f) & int(std::abs(z[j]) <= 1e18f);
      bad += !good;
      x[j] = good ? x[j] : not_a_number;
    }
    return bad;
  }
};

namespace detail {

/// Least and largest of many numbers, NaN left out, in lanes side by side so that they become vectors.
template <std::size_t Lanes>
struct extremes {
  alignas(64) real low[Lanes], high[Lanes];

  extremes() {
    for (std::size_t j = 0; j < Lanes; ++j) low[j] = infinity, high[j] = -infinity;
  }
  void add(const real* f) {
    for (std::size_t j = 0; j < Lanes; ++j) {
      const real v = f[j];
      low[j] = v < low[j] ? v : low[j];
      high[j] = v > high[j] ? v : high[j];
    }
  }
};

inline void spread(const real* values, real& low, real& high) {
  constexpr std::size_t lanes = 16;
  extremes<lanes> all;
  for (std::size_t i = 0; i < tile_points; i += lanes) all.add(values + i);
  for (std::size_t j = 0; j < lanes; ++j) low = min(low, all.low[j]), high = max(high, all.high[j]);
}

/// The box around a tile of x, y, z, one after another, without taking them apart.
inline tile_box box_of(const real* f) {
  constexpr std::size_t lanes = 24;
  extremes<lanes> all;
  for (std::size_t i = 0; i < 3 * tile_points; i += lanes) all.add(f + i);
  for (std::size_t j = 0; j < lanes / 2; ++j) {
    all.low[j] = min(all.low[j], all.low[j + lanes / 2]);
    all.high[j] = max(all.high[j], all.high[j + lanes / 2]);
  }
  tile_box box;
  for (std::size_t j = 0; j < lanes / 2; j += 3) {
    box.lower = {min(box.lower.x, all.low[j]), min(box.lower.y, all.low[j + 1]), min(box.lower.z, all.low[j + 2])};
    box.upper = {max(box.upper.x, all.high[j]), max(box.upper.y, all.high[j + 1]), max(box.upper.z, all.high[j + 2])};
  }
  return box;
}

/// Is every number finite? Says no, too, if their sum is not.
inline bool sum_is_finite(const real* f) {
  constexpr std::size_t lanes = 16;
  alignas(64) real sums[lanes] = {};
  for (std::size_t i = 0; i < 3 * tile_points; i += lanes)
    for (std::size_t j = 0; j < lanes; ++j) sums[j] += f[i + j];
  for (std::size_t half = lanes / 2; half >= 4; half /= 2)
    for (std::size_t j = 0; j < half; ++j) sums[j] += sums[j + half];
  const real sum = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  return sum - sum == 0;
}

/// Points of which some coordinate is not finite, of a whole tile.
inline std::uint32_t count_not_finite(const real* f) {
  constexpr std::size_t lanes = 24;
  alignas(64) std::uint32_t bad[3 * tile_points + 2] = {}, sums[lanes] = {}, all = 0;
  for (std::size_t i = 0; i < 3 * tile_points; ++i) bad[i] = !(std::abs(f[i]) <= 1e18f);  // as is_finite
  for (std::size_t i = 0; i < 3 * tile_points; i += lanes)
    for (std::size_t j = 0; j < lanes; ++j) sums[j] += bad[i + j] | bad[i + j + 1] | bad[i + j + 2];
  for (std::size_t j = 0; j < lanes; j += 3) all += sums[j];  // the other sums are of neighbours' parts
  return all;
}

struct surveyed {
  tile_box box;
  std::uint32_t not_finite;
};
inline surveyed survey_here(const real* f) {
  const tile_box box = box_of(f);
  if (sum_is_finite(f) && is_finite(box.lower) && is_finite(box.upper)) return {box, 0};
  return {box, box.lower.x > box.upper.x ? std::uint32_t(tile_points) : count_not_finite(f)};
}
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__AVX2__)
/// Twice as wide where the processor can, without a compiler flag; boxes and counts are the same.
__attribute__((target("avx2"), flatten)) inline surveyed survey_avx2(const real* f) { return survey_here(f); }
inline surveyed survey(const real* f) { return __builtin_cpu_supports("avx2") ? survey_avx2(f) : survey_here(f); }
#else
inline surveyed survey(const real* f) { return survey_here(f); }
#endif

/// The least and largest depth of a tile of pixels, and how many of them are none.
template <class Pixel>
struct depths {
  Pixel ends[2];
  std::uint32_t missing = 0, saturated = 0, not_finite = 0;
  bool strange = false;  ///< Some are too large to say what becomes of them.

  explicit depths(const std::uint16_t* pixels) {
    // 0 and 65535 are no depths: one less and one more takes them to the far end.
    std::uint16_t low = 65535, high = 0, zeros = 0, full = 0;
    for (std::size_t j = 0; j < tile_points; ++j) {
      const std::uint16_t d = pixels[j], less = std::uint16_t(d - 1), more = std::uint16_t(d + 1);
      low = less < low ? less : low;
      high = more > high ? more : high;
      zeros = std::uint16_t(zeros + (d == 0)), full = std::uint16_t(full + (d == 65535));
    }
    missing = zeros, saturated = full;
    ends[0] = std::uint16_t(low + 1), ends[1] = std::uint16_t(high - 1);
  }
  explicit depths(const real* pixels) {
    std::uint32_t huge = 0;
    alignas(64) real depth[tile_points];
    for (std::size_t j = 0; j < tile_points; ++j) {
      const real d = pixels[j], size = std::abs(d);
      missing += d == 0, not_finite += !(size < infinity), huge += !(size <= 1e18f);
      depth[j] = d == 0 || !(size < infinity) ? not_a_number : d;
    }
    strange = huge != not_finite;
    ends[0] = infinity, ends[1] = -infinity;
    spread(depth, ends[0], ends[1]);
  }
};

}  // namespace detail

/// The box from coordinates that are there already.
inline tile_box box_of(const tile& t) {
  tile_box box;
  detail::spread(t.x, box.lower.x, box.upper.x);
  detail::spread(t.y, box.lower.y, box.upper.y);
  detail::spread(t.z, box.lower.z, box.upper.z);
  return box;
}

/// Counts what a whole tile drops and says where the rest is, without loading it; false: this source cannot.
template <point_source S>
bool survey(const S&, std::size_t, tile_box&, tally&) {
  return false;
}

inline bool survey(const point_span& source, std::size_t begin, tile_box& box, tally& mine) {
  if (!source.filter.plain()) return false;
  const detail::surveyed seen = detail::survey(&source.points[begin].x);
  box = seen.box;
  mine.dropped[int(drop_reason::not_finite)] += seen.not_finite;
  return true;
}

/// Pixels are compared, and only the corners of what they span are deprojected: rounded arithmetic is monotonic too.
template <class Pixel>
bool survey(const depth_image<Pixel>& image, std::size_t begin, tile_box& box, tally& mine) {
  const std::size_t end = begin + tile_points - 1;
  const std::uint32_t v[2] = {std::uint32_t(begin / image.width), std::uint32_t(end / image.width)};
  if (v[0] != v[1] && image.row != image.width) return false;
  const std::uint32_t u[2] = {v[0] == v[1] ? std::uint32_t(begin % image.width) : 0,
                              v[0] == v[1] ? std::uint32_t(end % image.width) : image.width - 1};
  const detail::depths<Pixel> seen(image.pixels + std::size_t(v[0]) * image.row + begin % image.width);
  if (seen.strange) return false;
  box = {};
  if (seen.missing + seen.saturated + seen.not_finite < tile_points)
    for (const Pixel d : seen.ends)
      for (const std::uint32_t column : u)
        for (const std::uint32_t line : v) {
          const sample s = image.deproject(d, column, line);
          if (!s.valid()) return false;
          const vec3 p = s.position;
          box.lower = {min(box.lower.x, p.x), min(box.lower.y, p.y), min(box.lower.z, p.z)};
          box.upper = {max(box.upper.x, p.x), max(box.upper.y, p.y), max(box.upper.z, p.z)};
        }
  mine.dropped[int(drop_reason::missing)] += seen.missing;
  mine.dropped[int(drop_reason::saturated)] += seen.saturated;
  mine.dropped[int(drop_reason::not_finite)] += seen.not_finite;
  return true;
}

}  // namespace clearance::search
