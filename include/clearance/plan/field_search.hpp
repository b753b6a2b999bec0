// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// One configuration by branch and bound in the tree over the points alone: of each part a field says how near it is.

#include <clearance/plan/tree_search.hpp>
#include <clearance/robot/field.hpp>

namespace clearance::plan {

/// A node of the tree over the points, or one of its points, together with a part.
struct field_pair {
  real bound;  ///< No point below it is nearer.
  std::uint32_t at, part;
  std::uint8_t level;  ///< 0: a point; else one more than the level of the points' node.
  bool whole;          ///< Points may be inside the part's solid.
};

/// How many levels of a tree a search goes through: it begins with the nodes of the last of them. Few nodes and parts
/// would leave most of `lanes` idle. (Without fields it is no quicker.)
template <class Tree>
CLEARANCE_HD std::uint32_t searched_levels(const Tree& tree, std::uint32_t parts, std::uint32_t lanes) {
  std::uint32_t levels = tree.levels;
  while (levels > 1 && std::uint64_t(tree.size(levels - 2)) * parts <= lanes) --levels;
  return levels;
}

/// As tree_search, for parts that have fields. Points are left for an exact search at its end: by then nearly all of
/// them are known to be too far.
template <class Body, class Tree>
struct field_search {
  using part_view = std::remove_cvref_t<decltype(*std::declval<Body>().parts)>;
  using pair = field_pair;
  static constexpr bool solid = scan::has_interior<part_view>;

  const Body& body;
  const Tree& tree;
  const ball_bounds* bounds;  ///< One per part.
  const field_view* fields;
  std::uint32_t levels;  ///< See searched_levels.

  CLEARANCE_HD std::uint32_t starts() const { return levels == 0 ? 0 : tree.size(levels - 1) * body.part_count; }
  CLEARANCE_HD bool start(std::uint32_t i, pair& p) const {
    const std::uint32_t top = tree.size(levels - 1);
    p = {-infinity, i % top, i / top, std::uint8_t(levels), solid};
    return examine(p);
  }
  CLEARANCE_HD std::uint32_t children(const pair& p) const {
    return p.level == 0 ? 1 : tree.end_below(p.level - 1, p.at) - tree.first_below(p.level - 1, p.at);
  }
  /// Child `j`; false if nothing in it matters any more. A point's child is the point.
  CLEARANCE_HD bool child(const pair& p, std::uint32_t j, pair& c) const {
    c = p;
    if (p.level != 0) c.at = tree.first_below(p.level - 1, p.at) + j, --c.level;
    return examine(c);
  }
  bool is_small(const pair& p) const { return p.level == 0; }
  void look_at_points(const pair& p) const { visit(tree.point(p.at), p.part); }
  template <class Point>
  CLEARANCE_HD void visit(const Point& p, std::uint32_t k) const {
    body.visit(element_less(p, body.origin), body.first + p.number, k);
  }

  /// Is there nothing left to learn from the pair?
  CLEARANCE_HD bool settled(const pair& p) const {
    if (!(p.bound <= body.answer.reach(p.part))) return true;
    if constexpr (solid) return body.answer.settled(body.first + least(p), 0);
    return false;
  }
  using order_type = pair_order<part_view>;
  CLEARANCE_HD order_type order(const pair& p) const {
    if constexpr (solid)
      return body.answer.lowest_first(p.part) ? make_key(0, least(p)) : make_key(p.bound, 0);
    else
      return ordered(p.bound);
  }

  /// A point that is known to be near: where to begin.
  CLEARANCE_HD void seed(const cloud_tree::numbered_point& p, std::uint32_t k) const {
    look_from(p.at - body.origin, 0, k);
  }

 private:
  CLEARANCE_HD std::uint32_t node_of(const pair& p) const { return tree.begin[p.level - 1] + p.at; }
  CLEARANCE_HD std::uint32_t least(const pair& p) const {
    return p.level == 0 ? tree.points[p.at].number : tree.least[node_of(p)];
  }
  /// Bounds on the distance from all that lies within `radius` of x to the part's primitives. The upper one is told.
  CLEARANCE_HD field_range look_from(vec3 x, real radius, std::uint32_t k) const {
    const field_range its = fields[k](body.places[k].part_from_cloud(x));
    if (const real most = bounds[k].upper(its.high, radius); most < body.answer.reach(k))
      body.answer.lower(none, k, most);
    return {bounds[k].lower(its.low, radius), its.high, its.side};
  }
  /// A lower bound on the distance of a box of points, which may be `wide`, from a part's ball, below 0 inside.
  CLEARANCE_HD real beyond_ball(const extent& box, real wide, std::uint32_t k) const {
    const ball& around = body.places[k].around;
    const vec3 low = box.lower - body.origin - around.center, high = around.center - (box.upper - body.origin);
    const vec3 beyond{rough_max(rough_max(low.x, high.x), 0), rough_max(rough_max(low.y, high.y), 0),
                      rough_max(rough_max(low.z, high.z), 0)};
    const real away = rough_length(beyond) - wide;
    return bounds[k].lower(away, around.radius);
  }
  /// Finds a pair's bound. Returns false if nothing in it matters.
  CLEARANCE_HD bool examine(pair& p) const {
    ball b;
    extent box;
    real wide = 0;
    if (p.level == 0) {
      const auto here = tree.point(p.at);
      if constexpr (Tree::of_balls) wide = here.radius;
      b = {here.at, here.number == none ? -1.0f : 0.0f}, box = {here.at, here.at};
    } else {
      b = tree.balls[node_of(p)], box = tree.boxes[node_of(p)];
      if constexpr (Tree::of_balls) wide = tree.widest[node_of(p)];
    }
    if (!(b.radius >= 0)) return false;  // no point of it counts
    if constexpr (Tree::of_balls) wide = wide * (1 + 4 * slack), b.radius = (b.radius + wide) * (1 + slack);
    p.bound = max(p.bound, beyond_ball(box, wide, p.part));
    if (settled(p)) return false;
    const field_range its = look_from(b.center - body.origin, b.radius, p.part);
    // A solid's inside changes only near its surface, within its tolerance.
    if (solid && p.whole && its.low > body.parts[p.part].facts.tolerance && its.side == field_side::outside)
      p.whole = false;
    p.bound = max(p.bound, p.whole ? min(its.low, 0) : its.low);
    return !settled(p);
  }
};

}  // namespace clearance::plan
