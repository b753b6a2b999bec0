// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A tree over the points of a cloud, for questions with so many poses that building it pays.

#include <clearance/concepts/capsule.hpp>
#include <clearance/ground/math.hpp>
#include <clearance/point_source.hpp>

namespace clearance::cloud_tree {

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
      begin[levels + 1] = begin[levels] + size, ++levels;
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
