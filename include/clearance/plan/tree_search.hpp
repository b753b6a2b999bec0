// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// One configuration by branch and bound in the tree over the points: together with the trees of the parts, or with
// fields, which say how near each part is.

#include <clearance/cloud_tree/tree_view.hpp>
#include <clearance/plan/asked.hpp>
#include <clearance/robot/field.hpp>
#include <clearance/scan/scan_body.hpp>

namespace clearance::plan {

/// Bounds on a part's distance to the points in a ball, from its distance to the ball's middle: that distance less or
/// plus the radius, with rounding at both ends.
struct ball_bounds {
  real most;  ///< What arithmetic can cost at distance 0.

  ball_bounds() = default;
  /// Twice what is needed: either end is off by at most `unit_error` times twice the part's extent, that distance, and
  /// the radius.
  CLEARANCE_HD ball_bounds(const part_facts& facts, const rigid_transform& part_from_cloud) {
    const double extent = double(length(facts.center)) + facts.radius + length(part_from_cloud.translation);
    most = rounded_up(4 * frames::arithmetic_error(extent));
  }
  CLEARANCE_HD real off(real distance, real radius) const { return most + 4 * slack * (absolute(distance) + radius); }
  /// If the middle is farther than this, no point is within reach.
  CLEARANCE_HD real within(real reach, real radius) const {
    const real sum = reach + radius;
    return sum + 2 * off(sum, radius);
  }
  CLEARANCE_HD real lower(real distance, real radius) const { return distance - radius - off(distance, radius); }
  CLEARANCE_HD real upper(real distance, real radius) const { return distance + radius + off(distance, radius); }
};

/// The order of pairs. If a part has an interior, lower numbers may have to go first.
template <class PartView>
using pair_order = std::conditional_t<scan::has_interior<PartView>, distance_key, std::uint32_t>;

/// What both searches have in common: one configuration's parts in one cloud, and a tree over its points. `Body` is a
/// scan_body, whose answer says how near a part must be. A pair is a node of that tree, or one of its points, and a
/// part: `at` is the node's or point's number, `level` is 0 for a point, else one more than the node's level.
template <class Body, class Tree>
struct points_search {
  using part_view = std::remove_cvref_t<decltype(*std::declval<Body>().parts)>;
  using order_type = pair_order<part_view>;
  static_assert(searching_tally<decltype(std::declval<Body>().answer)>);
  static constexpr bool solid = scan::has_interior<part_view>;

  const Body& body;
  const Tree& tree;
  const ball_bounds* bounds;  ///< One per part.

  /// How near part `k` must be.
  CLEARANCE_HD real reach(std::uint32_t k) const { return body.answer.reach(k); }
  template <class Point>
  CLEARANCE_HD void visit(const Point& p, std::uint32_t k) const {
    body.visit(element_less(p, body.origin), body.first + p.number, k);
  }

  /// Is there nothing left to learn from the pair?
  template <class Pair>
  CLEARANCE_HD bool settled(const Pair& p) const {
    if (!(p.bound <= reach(p.part))) return true;
    if constexpr (solid) return body.answer.settled(body.first + least(p), 0);
    return false;
  }

  /// Of two pairs the nearer goes first. A part with an interior has no distance below 0; once 0 is found, the lowest
  /// number goes first.
  template <class Pair>
  CLEARANCE_HD order_type order(const Pair& p) const {
    if constexpr (solid)
      return body.answer.lowest_first(p.part) ? make_key(0, least(p)) : make_key(p.bound, 0);
    else
      return ordered(p.bound);
  }

 protected:
  template <class Pair>
  CLEARANCE_HD std::uint32_t node_of(const Pair& p) const {
    return tree.begin[p.level - 1] + p.at;
  }
  /// The lowest number of the pair's points.
  template <class Pair>
  CLEARANCE_HD std::uint32_t least(const Pair& p) const {
    return p.level == 0 ? tree.points[p.at].number : tree.least[node_of(p)];
  }
  /// About the distance of a position, less the origin, from a box of points.
  CLEARANCE_HD real from_box(const extent& box, vec3 p) const {
    const vec3 low = box.lower - body.origin - p, high = p - (box.upper - body.origin);
    return rough_length({rough_max(rough_max(low.x, high.x), 0), rough_max(rough_max(low.y, high.y), 0),
                         rough_max(rough_max(low.z, high.z), 0)});
  }
};

/// A node of the tree over the points, or one of its points, together with a node of a part's tree.
template <class Node>
struct node_pair {
  real bound;  ///< No point and primitive below them are nearer.
  std::uint32_t at, part;
  std::uint32_t from;  ///< The children before this one are done.
  Node node;
  std::uint8_t level;
  std::uint8_t depth;  ///< Depth of `node`; the count stops at 255.
  bool by_points;      ///< The points' node is to be opened.
  bool whole;          ///< Points may be inside the part's solid: `node` stays the root.
};

/// The search by the trees of the parts: the larger of a pair's two nodes is opened.
template <class Body, class Tree>
struct tree_search : points_search<Body, Tree> {
  using search = points_search<Body, Tree>;
  using search::body, search::tree, search::bounds, search::solid, search::reach, search::visit;
  using typename search::part_view;
  using hierarchy_type = typename part_view::hierarchy_type;
  using volume_type = typename hierarchy_type::volume_type;
  using traits = bounding_volume_traits<volume_type>;
  using pair = node_pair<typename hierarchy_type::node_type>;

  /// The number of pairs to begin with: each node of the top level with each part.
  CLEARANCE_HD std::uint32_t starts() const {
    return tree.levels == 0 ? 0 : tree.size(tree.levels - 1) * body.part_count;
  }
  CLEARANCE_HD bool start(std::uint32_t i, pair& p) const {
    const std::uint32_t top = tree.size(tree.levels - 1);
    p = {.bound = -infinity,
         .at = i % top,
         .part = i / top,
         .from = 0,
         .node = body.parts[i / top].tree.root(),
         .level = std::uint8_t(tree.levels),
         .depth = 0,
         .by_points = true,
         .whole = solid};
    return examine(p);
  }
  CLEARANCE_HD std::uint32_t children(const pair& p) const {
    return p.by_points ? tree.end_below(p.level - 1, p.at) - tree.first_below(p.level - 1, p.at)
                       : body.parts[p.part].tree.size(p.node);
  }
  /// Child `j`; false if nothing in it matters any more.
  CLEARANCE_HD bool child(const pair& p, std::uint32_t j, pair& c) const {
    c = p;
    c.from = 0;
    if (p.by_points) {
      c.at = tree.first_below(p.level - 1, p.at) + j;
      --c.level;
    } else {
      c.node = body.parts[p.part].tree.child(p.node, j);
      c.depth += c.depth != 255;
    }
    return examine(c);
  }

  /// Can bounds not tell a node's points apart? Then it is quicker to look at each point than to open nodes.
  bool is_small(const pair& p) const {
    return p.by_points && !p.whole && p.level != 0 && body.parts[p.part].tree.is_leaf(p.node) &&
           tree.balls[this->node_of(p)].radius <= bounds[p.part].most;
  }
  /// Looks at all points of a small node.
  void look_at_points(const pair& p) const {
    pair its = p;
    its.level = 0;
    std::uint32_t begin = p.at, end = p.at + 1;
    for (std::uint32_t level = p.level; level-- > 0;) {
      end = tree.end_below(level, end - 1);
      begin = tree.first_below(level, begin);
    }
    for (its.at = begin; its.at < end; ++its.at) look_at_point(its, tree.point(its.at));
  }

  /// A point that is known to be near: where to begin.
  template <class Point>
  CLEARANCE_HD void seed(const Point& p, std::uint32_t k) const {
    visit(p, k);
  }

 private:
  CLEARANCE_HD static bool inside(const part_view& part, vec3 q) {
    if constexpr (solid) return part.interior.inside(q);
    return false;
  }

  /// Finds a pair's bound, and which of its two nodes is to be opened. Returns false if nothing in it matters or all of
  /// it has been looked at.
  CLEARANCE_HD bool examine(pair& p) const {
    if (p.level == 0) return look_at_point(p, tree.point(p.at));
    const std::uint32_t node = this->node_of(p);
    ball b = tree.balls[node];
    if (!(b.radius >= 0)) return false;  // no point of it counts
    if constexpr (Tree::of_balls)
      b.radius = (b.radius + tree.widest[node]) * (1 + slack);  // around all balls
    else if (b.radius <= bounds[p.part].most && in_one_place(p))
      return look_at_point(p, cloud_tree::numbered_point{tree.boxes[node].lower, this->least(p)});
    const vec3 x = b.center - body.origin;
    if (solid && p.whole && !look_inside(p, b, x)) return false;
    p.by_points = true;
    if (!p.whole) {
      const part_view& part = body.parts[p.part];
      const volume_type& volume = part.tree.volume(p.node);
      real bound, size;
      if constexpr (round_volume<volume_type>) {
        const ball around = traits::as_ball(volume);
        size = around.radius;
        bound = bounds[p.part].lower(away(node, b, x, around.center, p.part), size);
      } else {
        bound = bounds[p.part].lower(traits::lower_bound(volume, body.places[p.part].part_from_cloud(x)), b.radius);
        size =
            part.facts.radius / real(1u << (p.depth < 20 ? p.depth * 3 / 2 : 30));  // surfaces of eight children each
      }
      p.bound = max(p.bound, bound);
      // The larger node is opened. The choice changes the work, and no answer.
      p.by_points = 10 * b.radius > 7 * size || part.tree.is_leaf(p.node);
    }
    return p.bound <= reach(p.part);
  }

  /// A lower bound on the distance from a position in a part to a node's points: from their box and from their ball.
  /// Its error is no larger than that of a point transformed into the part's frame: this is the same transform
  /// backwards.
  CLEARANCE_HD real away(std::uint32_t node, const ball& b, vec3 x, vec3 center, std::uint32_t k) const {
    const rigid_transform& to = body.places[k].part_from_cloud;
    const vec3 d = center - to.translation;
    const vec3 w{to.row[0].x * d.x + to.row[1].x * d.y + to.row[2].x * d.z,
                 to.row[0].y * d.x + to.row[1].y * d.y + to.row[2].y * d.z,
                 to.row[0].z * d.x + to.row[1].z * d.y + to.row[2].z * d.z};
    real least = this->from_box(tree.boxes[node], w);
    if constexpr (Tree::of_balls) least = least - tree.widest[node] * (1 + 4 * slack);
    return rough_max(least, rough_length(x - w) - b.radius * (1 + slack));
  }

  /// Do all of a node's points get the same computed position in the part's frame? Then the point with the lowest
  /// number stands for them: equal points, and points too close together for floats there. The computed position is
  /// monotone in each coordinate, so the box's corners decide. (They do not tell the sign of a sum of 0.)
  CLEARANCE_HD bool in_one_place(const pair& p) const {
    const extent& box = tree.boxes[this->node_of(p)];
    if (box.lower == box.upper) return true;
    const rigid_transform& to = body.places[p.part].part_from_cloud;
    const vec3 low = box.lower - body.origin, high = box.upper - body.origin;
    const auto one = [&](vec3 row, real t) {
      const auto along = [&](real x, real y, real z) { return fma(row.x, x, fma(row.y, y, fma(row.z, z, t))); };
      const bool x = row.x < 0, y = row.y < 0, z = row.z < 0;
      const real least = along(x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z);
      return least != 0 && least == along(x ? low.x : high.x, y ? low.y : high.y, z ? low.z : high.z);
    };
    return one(to.row[0], to.translation.x) && one(to.row[1], to.translation.y) && one(to.row[2], to.translation.z);
  }

  /// `here`: the pair's point, or the point that stands for a node.
  template <class Point>
  CLEARANCE_HD bool look_at_point(pair& p, const Point& here) const {
    if (here.number == none) return false;  // no point; a volume may return anything for NaN
    if (solid && p.whole) {
      visit(here, p.part);
      return false;
    }
    const auto& its = body.parts[p.part].tree;
    const auto q = scan::moved(body.places[p.part].part_from_cloud, element_less(here, body.origin));
    const real near = reach(p.part), bound = scan::bound_of(its.volume(p.node), q, near);
    if (!(bound <= near)) return false;
    if (!its.is_leaf(p.node)) {
      p.bound = max(p.bound, bound);
      p.by_points = false;
      return true;
    }
    auto ask = body.answer.visitor(body.first + here.number, p.part);
    scan::offer_leaf_for(its, p.node, q, ask);
    body.answer.take(body.first + here.number, p.part, ask);
    return false;
  }

  /// Points within a part's ball may be inside its solid. The distance from their ball's middle to the surface tells
  /// whether they may be, how near they can be, and how near some of them must be.
  CLEARANCE_HD bool look_inside(pair& p, const ball& b, vec3 x) const {
    const frames::placement& place = body.places[p.part];
    const part_view& part = body.parts[p.part];
    if (!frames::may_reach({place.around.center, place.around.radius + b.radius}, 0, x)) {
      p.whole = false;
      return true;
    }
    if (!Tree::of_balls && !(reach(p.part) >= 0)) return false;
    p.bound = max(p.bound, lowered(length(x - place.around.center) - place.around.radius - b.radius,
                                   place.around.radius + b.radius));
    if (!(b.radius < part.facts.radius)) return true;
    const vec3 q = place.part_from_cloud(x);
    if (inside(part, q)) return true;
    nearest near{bounds[p.part].within(reach(p.part), b.radius)};
    body.walk(part.tree, q, near);
    // Within its tolerance of the surface a solid may be wrong about its inside.
    const real least = bounds[p.part].lower(near.within, b.radius);
    const bool away = least > part.facts.tolerance;
    if (near.best == nearest::none) return !away;
    if (const real most = bounds[p.part].upper(near.within, b.radius); most < reach(p.part))
      body.answer.lower(none, p.part, most);
    p.whole = !away;
    if (!p.whole) p.bound = max(p.bound, least);
    return true;
  }
};

/// A node of the tree over the points, or one of its points, together with a part.
struct field_pair {
  real bound;  ///< No point below it is nearer.
  std::uint32_t at, part;
  std::uint8_t level;
  bool whole;  ///< Points may be inside the part's solid.
};

/// How many levels of a tree a search by fields goes through: it begins with the nodes of the last of them. Few nodes
/// and parts would leave most of `lanes` idle. (Without fields it is no quicker.)
template <class Tree>
CLEARANCE_HD std::uint32_t searched_levels(const Tree& tree, std::uint32_t parts, std::uint32_t lanes) {
  std::uint32_t levels = tree.levels;
  while (levels > 1 && std::uint64_t(tree.size(levels - 2)) * parts <= lanes) --levels;
  return levels;
}

/// The search by the fields of the parts. Points are left for an exact search at the end: by then nearly all of them
/// are known to be too far.
template <class Body, class Tree>
struct field_search : points_search<Body, Tree> {
  using search = points_search<Body, Tree>;
  using search::body, search::tree, search::bounds, search::solid, search::reach, search::visit, search::settled;
  using pair = field_pair;

  const field_view* fields;  ///< One per part.
  std::uint32_t levels;      ///< See searched_levels.

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
    if (p.level != 0) {
      c.at = tree.first_below(p.level - 1, p.at) + j;
      --c.level;
    }
    return examine(c);
  }

  bool is_small(const pair& p) const { return p.level == 0; }
  void look_at_points(const pair& p) const { visit(tree.point(p.at), p.part); }

  /// A point that is known to be near: where to begin.
  CLEARANCE_HD void seed(const cloud_tree::numbered_point& p, std::uint32_t k) const {
    look_from(p.at - body.origin, 0, k);
  }

 private:
  /// Bounds on the distance from all that lies within `radius` of x to the part's primitives. The upper one is told.
  CLEARANCE_HD field_range look_from(vec3 x, real radius, std::uint32_t k) const {
    const field_range its = fields[k](body.places[k].part_from_cloud(x));
    if (const real most = bounds[k].upper(its.high, radius); most < reach(k)) body.answer.lower(none, k, most);
    return {bounds[k].lower(its.low, radius), its.high, its.side};
  }
  /// A lower bound on the distance of a box of points, which may be `wide`, from a part's ball, below 0 inside.
  CLEARANCE_HD real beyond_ball(const extent& box, real wide, std::uint32_t k) const {
    const ball& around = body.places[k].around;
    return bounds[k].lower(this->from_box(box, around.center) - wide, around.radius);
  }
  /// Finds a pair's bound. Returns false if nothing in it matters.
  CLEARANCE_HD bool examine(pair& p) const {
    ball b;
    extent box;
    real wide = 0;
    if (p.level == 0) {
      const auto here = tree.point(p.at);
      if constexpr (Tree::of_balls) wide = here.radius;
      b = {here.at, here.number == none ? -1.0f : 0.0f};
      box = {here.at, here.at};
    } else {
      const std::uint32_t node = this->node_of(p);
      b = tree.balls[node];
      box = tree.boxes[node];
      if constexpr (Tree::of_balls) wide = tree.widest[node];
    }
    if (!(b.radius >= 0)) return false;  // no point of it counts
    if constexpr (Tree::of_balls) {
      wide = wide * (1 + 4 * slack);
      b.radius = (b.radius + wide) * (1 + slack);
    }
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
