// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The box of 128 points in one array, and how many of them are invalid.

#include <clearance/points/extremes.hpp>

namespace clearance::detail {

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
  std::uint32_t all = 0;
  for (std::size_t i = 0; i < 3 * surveyed_points; i += 3)  // as is_finite, without branches
    all += !(int(std::abs(f[i]) <= 1e18f) & int(std::abs(f[i + 1]) <= 1e18f) & int(std::abs(f[i + 2]) <= 1e18f));
  return all;
}

struct surveyed {
  extent box;
  std::uint32_t not_finite;
};
/// Prefetches what will be surveyed soon: otherwise the work on a tile would begin with a wait for memory. Prefetching
/// beyond the array does nothing.
inline void ask_ahead(const real* f) {
  constexpr std::size_t tile = 3 * surveyed_points * sizeof(real), tiles = 4, line = 64;
  const auto there = reinterpret_cast<std::uintptr_t>(f) + tiles * tile;
  for (std::size_t i = 0; i < tile; i += line) __builtin_prefetch(reinterpret_cast<const void*>(there + i));
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
