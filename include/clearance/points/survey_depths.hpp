// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/points/extremes.hpp>

namespace clearance::detail {

/// The least and largest depth of 128 pixels, and how many pixels hold none.
template <class Pixel>
struct depths {
  Pixel ends[2];
  std::uint32_t missing = 0, saturated = 0, not_finite = 0, minus_infinity = 0;
  bool strange = false;  ///< Some are so large that their points may fail is_finite.

  explicit depths(const std::uint16_t* pixels) {
    // 0 and 65535 are not depths: subtracting and adding one wraps them to the other end.
    std::uint16_t low = 65535, high = 0, zeros = 0, full = 0;
    for (std::size_t j = 0; j < surveyed_points; ++j) {
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
    alignas(64) real depth[surveyed_points];
    for (std::size_t j = 0; j < surveyed_points; ++j) {
      const real d = pixels[j], size = std::abs(d);
      missing += d == 0, not_finite += !(size < infinity), huge += !(size <= 1e18f);
      depth[j] = d == 0 || !(size < infinity) ? not_a_number : d;
    }
    strange = huge != not_finite;
    if (not_finite != 0)
      for (std::size_t j = 0; j < surveyed_points; ++j) minus_infinity += pixels[j] == -infinity;
    not_finite -= minus_infinity;
    ends[0] = infinity, ends[1] = -infinity;
    spread(depth, ends[0], ends[1]);
  }
};

}  // namespace clearance::detail
