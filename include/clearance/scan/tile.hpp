// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How the host reads a cloud: first only the box around a hundred points, in loops that compilers turn into vector code
// on every processor. Single coordinates are read only if a part may be near.

#include <clearance/points/extremes.hpp>
#include <clearance/scan/drops.hpp>

namespace clearance::scan {

inline constexpr std::size_t tile_points = surveyed_points;
inline constexpr std::size_t piece_points = 32 * tile_points;  ///< What one thread takes at a time.

/// The points of a tile, less the search's origin. An invalid point is NaN and fails every comparison.
struct tile {
  alignas(64) real x[tile_points], y[tile_points], z[tile_points];

  void put(std::size_t j, vec3 p) { x[j] = p.x, y[j] = p.y, z[j] = p.z; }
  vec3 operator[](std::size_t j) const { return {x[j], y[j], z[j]}; }

  /// Loads `count` points: begin, begin + stride, ...; counts dropped ones. The source is a copy that no write here can
  /// change, and only this loop reads it, so that compilers can split it into its members.
  template <point_source S>
  [[gnu::flatten]] void load(const S source, std::size_t begin, std::size_t count, std::size_t stride,
                             drop_tally& mine) {
    constexpr vec3 nowhere{not_a_number, not_a_number, not_a_number};
    for (std::size_t j = count; j < tile_points; ++j) put(j, nowhere);
    if constexpr (unfiltered_source<S>) {
      if (source.unfiltered()) {  // only finiteness is tested, in vector code
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

/// The box around points that are already loaded.
inline extent box_of(const tile& t) {
  extent box;
  spread(t.x, box.lower.x, box.upper.x);
  spread(t.y, box.lower.y, box.upper.y);
  spread(t.z, box.lower.z, box.upper.z);
  return box;
}

}  // namespace clearance::scan
