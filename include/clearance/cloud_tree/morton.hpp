// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// An order in which neighbours in space are neighbours in memory.

#include <clearance/ground/math.hpp>

namespace clearance::cloud_tree {

/// Numbers the cells of a grid along a Z-curve (Morton). It affects only a tree's speed, so it need not be the same
/// everywhere.
struct morton_grid {
  static constexpr int bits = 10;  ///< Per coordinate.
  static constexpr std::uint32_t samples = 256;

  vec3 low = {0, 0, 0};
  real per_metre = 0;

  morton_grid() = default;
  /// A grid around the space between two positions, and a little more. Points beyond it fall into the outermost cells.
  /// The positions are quantiles of samples and not the ends: a few far points, as lidars see, must not press the
  /// others into one.
  CLEARANCE_HD morton_grid(vec3 a, vec3 b) {
    const vec3 size = b - a;
    const real side = max(max(size.x, size.y), size.z) * 1.5f;
    low = {(a.x + b.x - side) / 2, (a.y + b.y - side) / 2, (a.z + b.z - side) / 2};
    per_metre = side > least_normal * (4 << bits) ? (1 << bits) / side : 0;  // never infinite
  }
  /// The ranks of these quantiles among `count` samples in ascending order.
  CLEARANCE_HD static std::uint32_t low_rank(std::uint32_t count) { return count / 16; }
  CLEARANCE_HD static std::uint32_t high_rank(std::uint32_t count) { return count - 1 - count / 16; }

  CLEARANCE_HD std::uint32_t operator()(vec3 p) const {
    return spread(cell(p.x - low.x)) | spread(cell(p.y - low.y)) << 1 | spread(cell(p.z - low.z)) << 2;
  }

 private:
  CLEARANCE_HD std::uint32_t cell(real offset) const {
    return std::uint32_t(min(max(offset * per_metre, 0), real((1 << bits) - 1)));
  }
  CLEARANCE_HD static std::uint32_t spread(std::uint32_t x) {
    x = (x | x << 16) & 0x030000ff, x = (x | x << 8) & 0x0300f00f, x = (x | x << 4) & 0x030c30c3;
    return (x | x << 2) & 0x09249249;
  }
};

}  // namespace clearance::cloud_tree
