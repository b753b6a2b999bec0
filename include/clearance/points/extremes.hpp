// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least and largest of many numbers, in loops that compilers turn into vector code on every processor.

#include <clearance/concepts.hpp>

#include <cmath>

namespace clearance {

/// Lanes lie side by side so that they become vectors. NaN is ignored.
template <std::size_t Lanes>
struct extremes {
  alignas(64) real low[Lanes], high[Lanes];

  extremes() {
    for (std::size_t j = 0; j < Lanes; ++j) {
      low[j] = infinity;
      high[j] = -infinity;
    }
  }
  void add(const real* f) {
    for (std::size_t j = 0; j < Lanes; ++j) {
      const real v = f[j];
      low[j] = v < low[j] ? v : low[j];
      high[j] = v > high[j] ? v : high[j];
    }
  }
};

/// The extremes of `count` values, a multiple of 16: usually of as many as a survey has points.
inline void spread(const real* values, real& low, real& high, std::size_t count = surveyed_points) {
  constexpr std::size_t lanes = 16;
  extremes<lanes> all;
  for (std::size_t i = 0; i < count; i += lanes) all.add(values + i);
  for (std::size_t j = 0; j < lanes; ++j) {
    low = min(low, all.low[j]);
    high = max(high, all.high[j]);
  }
}

}  // namespace clearance
