// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/math.hpp>

#include <cstdint>

namespace clearance {

/// The cubes of a grid that are cut off from outside: one bit each, in the words after this head.
template <class T>
struct enclosure_head {
  T low[3];
  T per_metre;
  std::uint32_t size[4];  ///< Along x, y and z; the last is spare.

  static constexpr std::size_t words = (4 * sizeof(T) + 16) / sizeof(std::uint32_t);

  /// Is the point in such a cube? False outside the grid, and for points that are not finite.
  CLEARANCE_HD bool contains(T x, T y, T z) const {
    const T at[3] = {(x - low[0]) * per_metre, (y - low[1]) * per_metre, (z - low[2]) * per_metre};
    for (int k = 0; k < 3; ++k)
      if (!(at[k] >= 0 && at[k] < T(size[k]))) return false;
    const std::uint32_t i = (std::uint32_t(at[2]) * size[1] + std::uint32_t(at[1])) * size[0] + std::uint32_t(at[0]);
    return (reinterpret_cast<const std::uint32_t*>(this)[words + i / 32] >> i % 32 & 1u) != 0;
  }
};

}  // namespace clearance
