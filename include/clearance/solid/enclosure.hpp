// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/enclosure_view.hpp>

#include <Eigen/Geometry>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

namespace clearance {

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

/// A grid of at most about `cubes` cubes around a box, with a spare layer on every side. Rows along x fill whole words.
inline enclosure_grid grid_around(const Eigen::AlignedBox3d& box, double cubes) {
  enclosure_grid g;
  const Eigen::Vector3d extent = box.sizes();
  const auto count = [&](double cube) {
    double all = 1;
    for (int k = 0; k < 3; ++k) all *= std::ceil(extent[k] / cube) + 3;
    return all;
  };
  g.cube = extent.maxCoeff() / 1024;
  while (count(g.cube) > cubes) g.cube *= 1.02;
  g.low = box.min() - Eigen::Vector3d::Constant(1.5 * g.cube);
  for (int k = 0; k < 3; ++k) g.size[k] = std::uint32_t(std::ceil(extent[k] / g.cube)) + 3;
  g.size[0] = (g.size[0] + 31) / 32 * 32;
  return g;
}

}  // namespace clearance
