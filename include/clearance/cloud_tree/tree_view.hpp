// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A tree over the points of a cloud, for questions with so many poses that building it pays. Points that are neighbours
// in space become neighbours in memory.

#include <clearance/concepts/capsule.hpp>
#include <clearance/ground/math.hpp>
#include <clearance/point_source.hpp>
#include <clearance/result.hpp>

namespace clearance::cloud_tree {

// An order in which neighbours in space are neighbours in memory.

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
    x = (x | x << 16) & 0x030000ff;
    x = (x | x << 8) & 0x0300f00f;
    x = (x | x << 4) & 0x030c30c3;
    return (x | x << 2) & 0x09249249;
  }
};

// An order of an image's pixels in which neighbours are neighbours in memory.

/// Squares of 64 x 64 pixels one after another, row by row, and the pixels of each along a Z-curve: eight pixels are a
/// tile of 4 x 2, eight tiles a square, and so on. Places beyond the image's edges have no number.
struct pixel_order {
  static constexpr bool counts = true;  ///< Invalid points were not counted before.
  static constexpr std::uint32_t bits = 6, side = 1 << bits;

  std::uint32_t width = 0, height = 0, squares = 0;  ///< `squares`: in a row.

  pixel_order() = default;
  /// Has no positions if the pixels are not whole rows, or if there are more places than numbers.
  pixel_order(std::uint32_t pixels, std::uint32_t columns) {
    if (columns == 0 || pixels % columns != 0) return;
    const std::uint64_t across = (std::uint64_t(columns) + side - 1) / side,
                        down = (std::uint64_t(pixels / columns) + side - 1) / side;
    if (across * down >> (32 - 2 * bits) == 0) {
      width = columns;
      height = pixels / columns;
      squares = std::uint32_t(across);
    }
  }
  std::uint32_t positions() const { return squares * ((height + side - 1) / side) * side * side; }

  CLEARANCE_HD std::uint32_t operator()(std::uint32_t i) const {
    const std::uint32_t square = i >> 2 * bits;
    const std::uint32_t x = square % squares * side + every_other(i), y = square / squares * side + every_other(i >> 1);
    return x < width && y < height ? y * width + x : none;
  }

  template <unsigned>
  CLEARANCE_HD std::uint32_t of_block(std::uint32_t i) const {
    return (*this)(i);
  }

 private:
  CLEARANCE_HD static std::uint32_t every_other(std::uint32_t i) {
    i &= 0x555;
    i = (i | i >> 1) & 0x333;
    i = (i | i >> 2) & 0x70f;
    return (i | i >> 4) & (side - 1);
  }
};

/// A valid point of a cloud, in the cloud's own coordinates, and its number there.
struct alignas(16) numbered_point {
  vec3 at;
  std::uint32_t number;
};

/// A point that is somewhere in a ball around its place.
struct numbered_ball : numbered_point {
  real radius;
};

/// A tree's point less an origin, or its ball.
CLEARANCE_HD inline vec3 element_less(const numbered_point& p, vec3 origin) { return p.at - origin; }
CLEARANCE_HD inline capsule element_less(const numbered_ball& p, vec3 origin) {
  return {p.at - origin, {0, 0, 0}, p.radius};
}

/// Balls around `Tile` neighbours each, above them balls around `Fan` balls each, until at most `Fan` are left. A
/// node's number tells where its children are, so nothing is stored about that.
template <std::uint32_t Tile, std::uint32_t Fan>
struct tree_view {
  static constexpr std::uint32_t tile = Tile, fan = Fan, most_levels = 16;
  static constexpr bool of_balls = false;

  const numbered_point* points = nullptr;  ///< Neighbours in space are neighbours here.
  const ball* balls = nullptr;             ///< Balls of all nodes, level by level, tiles first.
  const extent* boxes = nullptr;           ///< The tightest boxes of the same nodes.
  const std::uint32_t* least = nullptr;    ///< The lowest number of a node's points.
  std::uint32_t count = 0;                 ///< Number of points.
  std::uint32_t levels = 0;
  std::uint32_t begin[most_levels + 1] = {};  ///< Where each level's nodes begin, and after the last level their end.

  tree_view() = default;
  /// The shape over `count` points, without the arrays.
  CLEARANCE_HD explicit tree_view(std::uint32_t count) : count(count) {
    for (std::uint32_t size = count, group = Tile; count != 0; group = Fan) {
      size = (size - 1) / group + 1;
      begin[levels + 1] = begin[levels] + size;
      ++levels;
      if (size <= Fan) break;
    }
  }

  CLEARANCE_HD const numbered_point& point(std::uint32_t i) const { return points[i]; }
  CLEARANCE_HD std::uint32_t nodes() const { return begin[levels]; }
  CLEARANCE_HD std::uint32_t size(std::uint32_t level) const { return begin[level + 1] - begin[level]; }
  /// What is below node `n` of a level: nodes of the level below it, or points, from the first to one past the last.
  CLEARANCE_HD std::uint32_t first_below(std::uint32_t level, std::uint32_t n) const {
    return n * (level == 0 ? Tile : Fan);
  }
  CLEARANCE_HD std::uint32_t end_below(std::uint32_t level, std::uint32_t n) const {
    const std::uint32_t all = level == 0 ? count : size(level - 1), group = level == 0 ? Tile : Fan;
    return all - n * group < group ? all : (n + 1) * group;
  }
};

/// The same over balls: nodes are still around their middles, and each knows its greatest radius.
template <std::uint32_t Tile, std::uint32_t Fan>
struct ball_tree_view : tree_view<Tile, Fan> {
  static constexpr bool of_balls = true;

  const real* radii = nullptr;   ///< Of the points.
  const real* widest = nullptr;  ///< Of each node's points.

  CLEARANCE_HD numbered_ball point(std::uint32_t i) const { return {this->points[i], radii[i]}; }
};

/// What a tree that was built over `S` shows: its points, or its balls.
template <point_source S, std::uint32_t Tile, std::uint32_t Fan>
auto view_over(const tree_view<Tile, Fan>& points, const real* radii, const real* widest) {
  if constexpr (ball_source<S>)
    return ball_tree_view<Tile, Fan>{points, radii, widest};
  else
    return points;
}

/// The middle of a box, and the distance of its farthest corner. A radius may be too large by a rounding, never too
/// small.
CLEARANCE_HD inline vec3 middle(const extent& box) {
  return {(box.lower.x + box.upper.x) / 2, (box.lower.y + box.upper.y) / 2, (box.lower.z + box.upper.z) / 2};
}
CLEARANCE_HD inline real rough_length_up(vec3 d) {
  return square_root(d.x * d.x + d.y * d.y + d.z * d.z) * (1 + slack);
}
CLEARANCE_HD inline real farthest(const extent& box, vec3 from) {
  const vec3 up = box.upper - from, down = from - box.lower;
  return rough_length_up({max(up.x, down.x), max(up.y, down.y), max(up.z, down.z)});
}

}  // namespace clearance::cloud_tree
