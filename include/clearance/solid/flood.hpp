// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/box_triangle.hpp>
#include <clearance/solid/enclosure.hpp>

#include <array>
#include <vector>

namespace clearance {

/// Floods a grid from its border, through the faces of cubes that no triangle touches. Orientation does not matter, and
/// a gap narrower than a cube lets nothing through. A word holds 32 cubes of a row.
class flood {
 public:
  explicit flood(const enclosure_grid& grid)
      : grid_(grid), words_(grid.size[0] / 32), open_(words_ * grid.size[1] * grid.size[2], ~0u) {}

  /// Adds a triangle as a wall. Divides the grid into eighths, so that a large triangle costs no more than its surface.
  void add(const std::array<Eigen::Vector3d, 3>& corners) {
    std::uint32_t side = 1;
    while (side < *std::max_element(grid_.size, grid_.size + 3)) side *= 2;
    wall(corners, {0, 0, 0}, side);
  }

  /// The cubes that are neither wall nor reached, as words of the grid.
  std::vector<std::uint32_t> enclosed() const {
    const std::uint32_t ny = grid_.size[1], nz = grid_.size[2];
    std::vector<std::uint32_t> reached(open_.size(), 0);
    std::vector<bool> waits(std::size_t(ny) * nz, false);
    std::vector<std::uint32_t> rows, next;
    const auto wake = [&](std::uint32_t row) {
      if (!waits[row]) waits[row] = true, next.push_back(row);
    };
    reached[0] = 1;  // no wall comes near the outermost layer
    wake(0);
    while (!next.empty()) {
      rows.clear();
      rows.swap(next);
      for (const std::uint32_t row : rows) {
        waits[row] = false;
        if (!spread(row, reached) && row != 0) continue;
        const std::uint32_t y = row % ny, z = row / ny;
        if (y > 0) wake(row - 1);
        if (y + 1 < ny) wake(row + 1);
        if (z > 0) wake(row - ny);
        if (z + 1 < nz) wake(row + ny);
      }
    }
    for (std::size_t i = 0; i < open_.size(); ++i) reached[i] = open_[i] & ~reached[i];
    return reached;
  }

 private:
  void wall(const std::array<Eigen::Vector3d, 3>& corners, std::array<std::uint32_t, 3> first, std::uint32_t side) {
    for (int k = 0; k < 3; ++k)
      if (first[k] >= grid_.size[k]) return;
    const double half = (side / 2.0 + 1e-6) * grid_.cube;  // rounding must not lose a wall
    const Eigen::Vector3d middle =
        grid_.low + grid_.cube * Eigen::Vector3d(first[0] + side / 2.0, first[1] + side / 2.0, first[2] + side / 2.0);
    if (!box_meets_triangle(middle, half, corners)) return;
    if (side == 1) {
      open_[(std::size_t(first[2]) * grid_.size[1] + first[1]) * words_ + first[0] / 32] &= ~(1u << first[0] % 32);
      return;
    }
    const std::uint32_t h = side / 2;
    for (std::uint32_t k = 0; k < 8; ++k)
      wall(corners, {first[0] + (k & 1) * h, first[1] + (k >> 1 & 1) * h, first[2] + (k >> 2) * h}, h);
  }

  /// Spreads from the four neighbouring rows into a row, and along it. Returns whether it reached more.
  bool spread(std::uint32_t row, std::vector<std::uint32_t>& reached) const {
    const std::uint32_t ny = grid_.size[1], y = row % ny, z = row / ny;
    std::uint32_t* const here = reached.data() + row * words_;
    const std::uint32_t* const open = open_.data() + row * words_;
    bool more = false;
    const auto grow = [&](std::size_t w, std::uint32_t from) {
      std::uint32_t up = (here[w] | from) & open[w], down = up, may_up = open[w], may_down = open[w];
      for (int k = 1; k < 32; k *= 2) {
        up |= may_up & up << k, may_up &= may_up << k;
        down |= may_down & down >> k, may_down &= may_down >> k;
      }
      more = more || (up | down) != here[w];
      here[w] = up | down;
    };
    for (std::size_t w = 0; w < words_; ++w) {
      std::uint32_t beside = 0;
      const std::size_t at = row * words_ + w;
      if (y > 0) beside |= reached[at - words_];
      if (y + 1 < ny) beside |= reached[at + words_];
      if (z > 0) beside |= reached[at - words_ * ny];
      if (z + 1 < grid_.size[2]) beside |= reached[at + words_ * ny];
      grow(w, beside | (w > 0 ? here[w - 1] >> 31 : 0));
    }
    for (std::size_t w = words_; w-- > 1;) grow(w - 1, here[w] << 31);
    return more;
  }

  const enclosure_grid& grid_;
  std::size_t words_;
  std::vector<std::uint32_t> open_;
};

}  // namespace clearance
