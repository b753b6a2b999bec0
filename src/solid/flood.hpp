// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What triangles enclose, whatever their orientation and however they meet: a grid is flooded from outside.

#include <clearance/solid/enclosure.hpp>
#include <clearance/solid/exact_triangle.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

namespace clearance {

/// Does a triangle, even one without area, touch the cube of half side `half` around `middle`? By separating axes:
/// those of the cube, the triangle's normal, and the nine products of their edges (Akenine-Moeller 2001).
inline bool box_meets_triangle(const Eigen::Vector3d& middle, double half,
                               const std::array<Eigen::Vector3d, 3>& corners) {
  const Eigen::Vector3d v[3] = {corners[0] - middle, corners[1] - middle, corners[2] - middle};
  for (int k = 0; k < 3; ++k)
    if (std::min({v[0][k], v[1][k], v[2][k]}) > half || std::max({v[0][k], v[1][k], v[2][k]}) < -half) return false;
  const Eigen::Vector3d edge[3] = {v[1] - v[0], v[2] - v[1], v[0] - v[2]};
  const Eigen::Vector3d normal = edge[0].cross(edge[1]);
  if (std::abs(normal.dot(v[0])) > half * normal.cwiseAbs().sum()) return false;
  for (int e = 0; e < 3; ++e)
    for (int k = 0; k < 3; ++k) {  // the axis edge x unit vector k
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      const double p[3] = {edge[e][b] * v[0][a] - edge[e][a] * v[0][b], edge[e][b] * v[1][a] - edge[e][a] * v[1][b],
                           edge[e][b] * v[2][a] - edge[e][a] * v[2][b]};
      const double reach = half * (std::abs(edge[e][a]) + std::abs(edge[e][b]));
      if (std::min({p[0], p[1], p[2]}) > reach || std::max({p[0], p[1], p[2]}) < -reach) return false;
    }
  return true;
}

/// Floods a grid from its border, from cube to cube through their faces. A cube that a triangle touches is a wall. With
/// `passages` a second flood, which keeps its distance from all triangles, finds what lies behind narrow passages.
class flood {
 public:
  /// In cubes: passages up to this width are walls, and what is enclosed and deeper than this is found.
  static constexpr double width = 3.4641016151377544;  // 2 sqrt(3)

  flood(const enclosure_grid& grid, bool passages)
      : grid_(grid),
        words_(grid.size[0] / 32),
        open_(words_ * grid.size[1] * grid.size[2], ~0u),
        wide_(passages ? open_.size() : 0, ~0u) {}

  /// Adds a triangle as a wall.
  void add(const std::array<Eigen::Vector3d, 3>& corners) {
    sheet t{corners, exact_triangle(corners[0], corners[1], corners[2]), {}, {}};
    double cubes = 1;
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({corners[0][k], corners[1][k], corners[2][k]});
      const double most = grid_.size[k] - 1.0;
      t.first[k] = std::uint32_t(std::clamp(std::floor((low - grid_.low[k]) / grid_.cube - around()), 0.0, most));
      t.last[k] = std::uint32_t(std::clamp(std::floor((high - grid_.low[k]) / grid_.cube + around()), 0.0, most));
      cubes *= t.last[k] - t.first[k] + 1.0;
    }
    if (cubes <= 1000) return walls(t, t.first, t.last);
    std::uint32_t side = 1;
    while (side < *std::max_element(grid_.size, grid_.size + 3)) side *= 2;
    divide(t, {0, 0, 0}, side);
  }

  /// The cubes that are neither wall nor reached, as words of the grid.
  std::vector<std::uint32_t> enclosed() const {
    std::vector<std::uint32_t> inside = cut_off(open_);
    if (wide_.empty()) return inside;
    std::vector<std::uint32_t> core = cut_off(wide_);
    bool more = false;
    for (std::size_t i = 0; i < core.size(); ++i) more = more || (core[i] &= ~inside[i]) != 0;
    if (!more) return inside;
    for (int step = 0; step < 2; ++step) core = grown(core);  // towards the walls; less than `berth`, so not past them
    for (std::size_t i = 0; i < core.size(); ++i) inside[i] |= core[i];
    return inside;
  }

 private:
  using cube_index = std::array<std::uint32_t, 3>;
  // In cubes. The middles of two neighbouring cubes on both sides of a passage are not both farther than (width + 1) /
  // 2 from its edges. The middle of the cube of a point at depth `width` is: width - sqrt(3) / 2 is more.
  static constexpr double berth = (width + 1) / 2;

  std::size_t word(const cube_index& cube) const {
    return (std::size_t(cube[2]) * grid_.size[1] + cube[1]) * words_ + cube[0] / 32;
  }
  Eigen::Vector3d middle(const cube_index& first, std::uint32_t side) const {
    const double half = side / 2.0;
    return grid_.low + grid_.cube * Eigen::Vector3d(first[0] + half, first[1] + half, first[2] + half);
  }

  struct sheet {
    std::array<Eigen::Vector3d, 3> corners;
    exact_triangle exact;
    cube_index first, last;  // beyond these it does not matter
  };

  void wall(const sheet& t, const cube_index& cube, std::size_t at, std::uint32_t bit) {
    const bool asked = !wide_.empty() && (wide_[at] & bit) != 0, open = (open_[at] & bit) != 0;
    const Eigen::Vector3d here = middle(cube, 1);
    constexpr double touching = 0.8661;  // the half diagonal, and more than rounding
    const double far = (asked ? berth : touching) * grid_.cube, distance = t.exact.nearer(here, far);
    if (!(distance < far)) return;
    if (asked) wide_[at] &= ~bit;
    if (open && distance < touching * grid_.cube && box_meets_triangle(here, (0.5 + 1e-6) * grid_.cube, t.corners))
      open_[at] &= ~bit;
  }
  /// Of some cubes those that are not yet walls; word by word, and bit by bit.
  void walls(const sheet& t, const cube_index& first, const cube_index& last) {
    for (std::uint32_t z = first[2]; z <= last[2]; ++z)
      for (std::uint32_t y = first[1]; y <= last[1]; ++y)
        for (std::uint32_t x = first[0]; x <= last[0]; x = (x / 32 + 1) * 32) {
          const std::size_t at = word({x, y, z});
          const std::uint32_t end = std::min(last[0], x / 32 * 32 + 31), count = end - x + 1;
          std::uint32_t left = unsettled(at) & ((~0u >> (32 - count)) << x % 32);
          for (; left != 0; left &= left - 1)
            wall(t, {x / 32 * 32 + std::uint32_t(std::countr_zero(left)), y, z}, at, left & (~left + 1));
        }
  }
  std::uint32_t unsettled(std::size_t at) const { return open_[at] | (wide_.empty() ? 0 : wide_[at]); }

  /// Divides the grid into eighths, so that a large triangle costs no more than its surface.
  void divide(const sheet& t, const cube_index& first, std::uint32_t side) {
    cube_index low, high;
    for (int k = 0; k < 3; ++k) {
      low[k] = std::max(first[k], t.first[k]);
      high[k] = std::min(first[k] + side - 1, t.last[k]);
      if (low[k] > high[k]) return;
    }
    if (side <= 32 && settled(low, high)) return;
    if (!box_meets_triangle(middle(first, side), (side / 2.0 + around()) * grid_.cube, t.corners)) return;
    if (side <= 4) return walls(t, low, high);
    const std::uint32_t h = side / 2;
    for (std::uint32_t k = 0; k < 8; ++k)
      divide(t, {first[0] + (k & 1) * h, first[1] + (k >> 1 & 1) * h, first[2] + (k >> 2) * h}, h);
  }
  /// Are all cubes of a block, of one word in each row, walls already?
  bool settled(const cube_index& first, const cube_index& last) const {
    const std::uint32_t bits = (~0u >> (31 - (last[0] - first[0]))) << first[0] % 32;
    for (std::uint32_t z = first[2]; z <= last[2]; ++z)
      for (std::uint32_t y = first[1]; y <= last[1]; ++y)
        if ((unsettled(word({first[0], y, z})) & bits) != 0) return false;
    return true;
  }
  /// How far beyond its cubes a triangle matters, in cubes: rounding must not lose a wall.
  double around() const { return wide_.empty() ? 1e-6 : berth; }

  /// Of these cubes, those that are not reached from the grid's border through others of them.
  std::vector<std::uint32_t> cut_off(const std::vector<std::uint32_t>& open) const {
    const std::uint32_t ny = grid_.size[1], nz = grid_.size[2];
    std::vector<std::uint32_t> reached(open.size(), 0);
    std::vector<bool> waits(std::size_t(ny) * nz, false);
    std::vector<std::uint32_t> rows, next;
    const auto wake = [&](std::uint32_t row) {
      if (!waits[row]) {
        waits[row] = true;
        next.push_back(row);
      }
    };
    for (std::uint32_t row = 0; row < ny * nz; ++row) {
      const std::uint32_t y = row % ny, z = row / ny;
      const std::size_t first = row * words_, last = first + words_ - 1;
      if (y == 0 || y + 1 == ny || z == 0 || z + 1 == nz)
        std::copy(open.begin() + std::ptrdiff_t(first), open.begin() + std::ptrdiff_t(last) + 1,
                  reached.begin() + std::ptrdiff_t(first));
      reached[first] |= open[first] & 1u;
      reached[last] |= open[last] & 1u << 31;
      wake(row);
    }
    while (!next.empty()) {
      rows.clear();
      rows.swap(next);
      for (const std::uint32_t row : rows) {
        waits[row] = false;
        if (!spread(row, open, reached)) continue;
        const std::uint32_t y = row % ny, z = row / ny;
        if (y > 0) wake(row - 1);
        if (y + 1 < ny) wake(row + 1);
        if (z > 0) wake(row - ny);
        if (z + 1 < nz) wake(row + ny);
      }
    }
    for (std::size_t i = 0; i < open.size(); ++i) reached[i] = open[i] & ~reached[i];
    return reached;
  }

  /// The neighbours, of these words' cubes in the four rows beside a row, at its word `w`.
  std::uint32_t beside(const std::vector<std::uint32_t>& cubes, std::uint32_t row, std::size_t w) const {
    const std::uint32_t ny = grid_.size[1], y = row % ny, z = row / ny;
    const std::size_t at = row * words_ + w;
    std::uint32_t sum = 0;
    if (y > 0) sum |= cubes[at - words_];
    if (y + 1 < ny) sum |= cubes[at + words_];
    if (z > 0) sum |= cubes[at - words_ * ny];
    if (z + 1 < grid_.size[2]) sum |= cubes[at + words_ * ny];
    return sum;
  }

  /// Spreads from the four neighbouring rows into a row, and along it. Returns whether it reached more.
  bool spread(std::uint32_t row, const std::vector<std::uint32_t>& all, std::vector<std::uint32_t>& reached) const {
    std::uint32_t* const here = reached.data() + row * words_;
    const std::uint32_t* const open = all.data() + row * words_;
    bool more = false;
    const auto grow = [&](std::size_t w, std::uint32_t from) {
      std::uint32_t up = (here[w] | from) & open[w], down = up, may_up = open[w], may_down = open[w];
      for (int k = 1; k < 32; k *= 2) {
        up |= may_up & up << k, may_up &= may_up << k;
        down |= may_down & down >> k;
        may_down &= may_down >> k;
      }
      more = more || (up | down) != here[w];
      here[w] = up | down;
    };
    for (std::size_t w = 0; w < words_; ++w) grow(w, beside(reached, row, w) | (w > 0 ? here[w - 1] >> 31 : 0));
    for (std::size_t w = words_; w-- > 1;) grow(w - 1, here[w] << 31);
    return more;
  }

  /// These cubes and their neighbours, walls left out.
  std::vector<std::uint32_t> grown(const std::vector<std::uint32_t>& cubes) const {
    std::vector<std::uint32_t> more(cubes.size());
    for (std::uint32_t row = 0; row < grid_.size[1] * grid_.size[2]; ++row)
      for (std::size_t w = 0, at = row * words_; w < words_; ++w, ++at) {
        std::uint32_t all = cubes[at] | cubes[at] << 1 | cubes[at] >> 1 | beside(cubes, row, w);
        if (w > 0) all |= cubes[at - 1] >> 31;
        if (w + 1 < words_) all |= cubes[at + 1] << 31;
        more[at] = all & open_[at];
      }
    return more;
  }

  const enclosure_grid& grid_;
  std::size_t words_;
  std::vector<std::uint32_t> open_;  // not touched by a triangle
  std::vector<std::uint32_t> wide_;  // farther than `berth` from all triangles; empty if nobody asks
};

}  // namespace clearance
