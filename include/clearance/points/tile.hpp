// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// As many points as a host takes apart together, coordinate by coordinate.

#include <clearance/points/extremes.hpp>

#include <cmath>

namespace clearance {

/// Positions of 128 points. Those that do not count are NaN.
struct point_tile {
  alignas(64) real x[surveyed_points], y[surveyed_points], z[surveyed_points];

  void put(std::size_t j, vec3 p) {
    x[j] = p.x;
    y[j] = p.y;
    z[j] = p.z;
  }
  vec3 operator[](std::size_t j) const { return {x[j], y[j], z[j]}; }

  /// Reads `count` points: begin, begin + stride, ...; counts dropped ones, by reason. A `read_source` does this
  /// itself.
  template <point_source S>
  void read(const S& source, std::size_t begin, std::size_t count, std::size_t stride,
            std::uint32_t (&dropped)[drop_reasons]) {
    if constexpr (read_source<S>)
      source.read(begin, count, stride, *this, dropped);
    else
      take_apart(source, begin, count, stride, dropped);
  }

 private:
  /// The source is a copy that no write here can change, and only this loop reads it, so that compilers can split it
  /// into its members.
  template <point_source S>
  [[gnu::flatten]] void take_apart(const S source, std::size_t begin, std::size_t count, std::size_t stride,
                                   std::uint32_t (&dropped)[drop_reasons]) {
    constexpr vec3 nowhere{not_a_number, not_a_number, not_a_number};
    for (std::size_t j = count; j < surveyed_points; ++j) put(j, nowhere);
    if constexpr (unfiltered_source<S>) {
      if (source.unfiltered()) {  // only finiteness is tested, in vector code
        for (std::size_t j = 0; j < count; ++j) put(j, source[begin + j * stride].position);
        dropped[int(drop_reason::not_finite)] += drop_not_finite() - std::uint32_t(surveyed_points - count);
        return;
      }
    }
    for (std::size_t j = 0; j < count; ++j) {
      const sample s = source[begin + j * stride];
      if (!s.valid()) ++dropped[int(s.dropped)];
      put(j, s.valid() ? s.position : nowhere);
    }
  }
  std::uint32_t drop_not_finite() {
    std::uint32_t bad = 0;
    for (std::size_t j = 0; j < surveyed_points; ++j) {
      // As is_finite, without branches.
      const bool good = int(std::abs(x[j]) <= 1e18f) & int(std::abs(y[j]) <= 1e18f) & int(std::abs(z[j]) <= 1e18f);
      bad += !good;
      x[j] = good ? x[j] : not_a_number;
    }
    return bad;
  }
};

}  // namespace clearance
