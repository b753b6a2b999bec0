// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which places are cut off from outside: one bit for each cube of a grid.

#include <clearance/ground/math.hpp>

#include <Eigen/Geometry>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

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

/// Owns the data of an enclosure_head: cubes of `cube` metres, starting at `low`.
struct enclosure_grid {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  double cube = 0;
  std::uint32_t size[3] = {0, 0, 0};
  std::vector<std::uint32_t> bits;  ///< Empty: nothing is enclosed.

  /// Cubic metres.
  double volume() const {
    double sum = 0;
    for (const std::uint32_t word : bits) sum += std::popcount(word);
    return sum * cube * cube * cube;
  }
  /// Head and bits, laid out as an `enclosure_head<T>` expects them; empty if nothing is enclosed.
  template <class T>
  std::vector<std::uint32_t> packed() const {
    if (bits.empty()) return {};
    enclosure_head<T> head{{T(low.x()), T(low.y()), T(low.z())}, T(1 / cube), {size[0], size[1], size[2], 0}};
    std::vector<std::uint32_t> words(head.words);
    std::memcpy(words.data(), &head, sizeof head);
    words.insert(words.end(), bits.begin(), bits.end());
    return words;
  }
};

}  // namespace clearance
