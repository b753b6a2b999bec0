// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// One configuration by branch and bound in two trees at once: the tree over the points, and a part's own. Also what may
// be asked about it: the least distance, or whether anything is within margins.

#include <clearance/cloud_tree/tree_view.hpp>
#include <clearance/concepts.hpp>
#include <clearance/frames/margins.hpp>
#include <clearance/ground/ordered.hpp>
#include <clearance/minimum/shared_bounds.hpp>
#include <clearance/result.hpp>
#include <clearance/scan/scan_body.hpp>

namespace clearance::plan {

/// Limits on computed distances: up to `may_be` a point may be within the part's margin; up to `is` it certainly is.
struct margin_reach {
  real may_be, is;
};

/// What is known of a configuration's points and margins. A smaller value is a stronger finding.
struct margin_word {
  static constexpr std::uint32_t certain = 0, possible = 1, nothing = 2;

  std::uint32_t found = nothing;
};

/// A part's visitor. It publishes what it is offered at once.
struct near_margin {
  using result_type = bool;

  margin_word* word;
  margin_reach near;

  CLEARANCE_HD std::uint32_t found() const { return load_relaxed(&word->found); }
  CLEARANCE_HD real reach() const {
    const std::uint32_t now = found();
    return now == margin_word::nothing ? near.may_be : now == margin_word::possible ? near.is : -infinity;
  }
  CLEARANCE_HD void offer(std::uint32_t, real distance) const {
    const std::uint32_t its = distance <= near.is       ? margin_word::certain
                              : distance <= near.may_be ? margin_word::possible
                                                        : margin_word::nothing;
    if (its < found()) lower_word(&word->found, its);
  }
  CLEARANCE_HD bool result() const { return found() == margin_word::certain; }
};
static_assert(visitor<near_margin>);

/// An answer of `scan_body`: is anything within margins? After a certain hit nothing more is looked at. After a
/// possible hit, only a certain hit can change the result. So the result does not depend on what was found first.
struct within_margins {
  margin_word* word;
  const margin_reach* margins;  ///< One per part.

  CLEARANCE_HD near_margin visitor(std::uint32_t, std::uint32_t k) const { return {word, margins[k]}; }
  CLEARANCE_HD void take(std::uint32_t, std::uint32_t, const near_margin&) const {}
  CLEARANCE_HD real reach(std::uint32_t k) const { return visitor(0, k).reach(); }
  CLEARANCE_HD real reach_of_pair(std::uint32_t, std::uint32_t k) const { return reach(k); }
  CLEARANCE_HD void lower(std::uint32_t, std::uint32_t k, real distance) const { visitor(0, k).offer(0, distance); }
  CLEARANCE_HD bool settled(std::uint32_t, std::uint32_t k) const { return visitor(0, k).result(); }
  CLEARANCE_HD bool touched(std::uint32_t, std::uint32_t) const { return false; }
  CLEARANCE_HD bool ended(std::uint32_t) const { return false; }
  CLEARANCE_HD bool foresees(std::uint32_t, std::uint32_t, vec3, bool, const near_margin&) const { return false; }
  CLEARANCE_HD bool lowest_first(std::uint32_t) const { return false; }
  CLEARANCE_HD bool take_inside(std::uint32_t, std::uint32_t k) const { return lower(0, k, 0), false; }
  CLEARANCE_HD void take_certain() const {}
};

// Questions about many configurations that search a tree over points. Each names an answer for `scan_body` and its
// initial value.

/// A configuration's minima of parts, if they decide what is certain, and how much farther each is looked for; or null.
struct of_parts {
  distance_key* best = nullptr;
  const real* extra = nullptr;
};

/// The least distance up to `d_max`, and its witness.
struct least_question {
  using answer_type = minimum::shared_bounds;
  using memory_type = minimum::totals;
  using result_type = min_distance_result;
  static constexpr bool by_margin = false;

  real d_max;

  bool limited() const { return d_max < infinity; }
  CLEARANCE_HD minimum::totals start(bool rigid = true) const { return {make_key(rigid ? d_max : -infinity, none)}; }
  CLEARANCE_HD static answer_type answer(minimum::totals* all, const margin_reach*, const of_parts& own) {
    return {all, own.best, own.extra};
  }
  /// Adds what another block has found.
  CLEARANCE_HD static void add(minimum::totals* all, const minimum::totals& found) {
    lower_to(&all->best, found.best);
    if (found.certain != 0) add_to(&all->certain, 1);
  }
};

/// Is anything nearer than the margins? One margin for all parts, or one per part.
struct margin_question {
  using answer_type = within_margins;
  using memory_type = margin_word;
  using result_type = state;
  static constexpr bool by_margin = true;

  const double* margins;
  std::uint32_t count;
  bool vague = false;  ///< No point is certainly anywhere.

  bool limited() const { return true; }
  CLEARANCE_HD margin_word start(bool = true) const { return {}; }
  CLEARANCE_HD static answer_type answer(margin_word* word, const margin_reach* near, const of_parts&) {
    return {word, near};
  }
  CLEARANCE_HD static void add(margin_word* word, const margin_word& found) { lower_word(&word->found, found.found); }
  CLEARANCE_HD margin_reach near(std::uint32_t k, const part_facts& facts, const frames::float_error& error) const {
    const double margin = margins[count == 1 ? 0 : k];
    return {frames::may_be_within(margin, facts, error), vague ? -infinity : frames::is_within(margin, facts, error)};
  }
  /// The state that in_collision reports for `word`.
  CLEARANCE_HD static state told(const margin_word& word, std::uint64_t valid, bool too_close) {
    if (valid == 0) return state::no_data;
    return word.found == margin_word::certain                 ? state::collision
           : word.found == margin_word::possible || too_close ? state::possible
                                                              : state::free;
  }
};

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

/// A node of the tree over the points, or one of its points, together with a node of a part's tree.
template <class Node>
struct node_pair {
  real bound;  ///< No point and primitive below them are nearer.
  std::uint32_t at, part;
  std::uint32_t from;  ///< The children before this one are done.
  Node node;
  std::uint8_t level;  ///< 0: a point; else one more than the level of the points' node.
  std::uint8_t depth;  ///< Depth of `node`; the count stops at 255.
  bool by_points;      ///< The points' node is to be opened.
  bool whole;          ///< Points may be inside the part's solid: `node` stays the root.
};

/// One configuration's parts in one cloud, and a tree over its points. `Body` is a scan_body, whose answer says how
/// near a part must be.
template <class Body, class Tree>
struct tree_search {
  using part_view = std::remove_cvref_t<decltype(*std::declval<Body>().parts)>;
  using hierarchy_type = typename part_view::hierarchy_type;
  using volume_type = typename hierarchy_type::volume_type;
  using traits = bounding_volume_traits<volume_type>;
  using pair = node_pair<typename hierarchy_type::node_type>;
  static_assert(searching_tally<decltype(std::declval<Body>().answer)>);
  static constexpr bool solid = scan::has_interior<part_view>;

  const Body& body;
  const Tree& tree;
  const ball_bounds* bounds;  ///< One per part.

  /// How near part `k` must be.
  CLEARANCE_HD real reach(std::uint32_t k) const { return body.answer.reach(k); }

  /// The number of pairs to begin with: each node of the top level with each part.
  CLEARANCE_HD std::uint32_t starts() const {
    return tree.levels == 0 ? 0 : tree.size(tree.levels - 1) * body.part_count;
  }
  CLEARANCE_HD bool start(std::uint32_t i, pair& p) const {
    const std::uint32_t top = tree.size(tree.levels - 1);
    p = {-infinity, i % top, i / top, 0, body.parts[i / top].tree.root(), std::uint8_t(tree.levels), 0, true, solid};
    return examine(p);
  }
  CLEARANCE_HD std::uint32_t children(const pair& p) const {
    return p.by_points ? tree.end_below(p.level - 1, p.at) - tree.first_below(p.level - 1, p.at)
                       : body.parts[p.part].tree.size(p.node);
  }
  /// Child `j`; false if nothing in it matters any more.
  CLEARANCE_HD bool child(const pair& p, std::uint32_t j, pair& c) const {
    c = p, c.from = 0;
    if (p.by_points)
      c.at = tree.first_below(p.level - 1, p.at) + j, --c.level;
    else
      c.node = body.parts[p.part].tree.child(p.node, j), c.depth += c.depth != 255;
    return examine(c);
  }

  /// Can bounds not tell a node's points apart? Then it is quicker to look at each point than to open nodes.
  bool is_small(const pair& p) const {
    return p.by_points && !p.whole && p.level != 0 && body.parts[p.part].tree.is_leaf(p.node) &&
           tree.balls[node_of(p)].radius <= bounds[p.part].most;
  }
  /// Looks at all points of a small node.
  void look_at_points(const pair& p) const {
    pair its = p;
    its.level = 0;
    std::uint32_t begin = p.at, end = p.at + 1;
    for (std::uint32_t level = p.level; level-- > 0;) {
      const std::uint32_t last = end - 1;
      end = tree.end_below(level, last), begin = tree.first_below(level, begin);
    }
    for (its.at = begin; its.at < end; ++its.at) look_at_point(its, tree.point(its.at));
  }

  /// Is there nothing left to learn from the pair?
  CLEARANCE_HD bool settled(const pair& p) const {
    if (!(p.bound <= reach(p.part))) return true;
    if constexpr (solid) return body.answer.settled(body.first + least(p), 0);
    return false;
  }
  /// Of two pairs the nearer goes first. A part with an interior has no distance below 0; once 0 is found, the lowest
  /// number goes first.
  using order_type = pair_order<part_view>;
  CLEARANCE_HD order_type order(const pair& p) const {
    if constexpr (solid)
      return body.answer.lowest_first(p.part) ? make_key(0, least(p)) : make_key(p.bound, 0);
    else
      return ordered(p.bound);
  }

  template <class Point>
  CLEARANCE_HD void visit(const Point& p, std::uint32_t k) const {
    body.visit(element_less(p, body.origin), body.first + p.number, k);
  }
  /// A point that is known to be near: where to begin.
  template <class Point>
  CLEARANCE_HD void seed(const Point& p, std::uint32_t k) const {
    visit(p, k);
  }

 private:
  CLEARANCE_HD std::uint32_t node_of(const pair& p) const { return tree.begin[p.level - 1] + p.at; }
  CLEARANCE_HD std::uint32_t least(const pair& p) const {
    return p.level == 0 ? tree.points[p.at].number : tree.least[node_of(p)];
  }
  CLEARANCE_HD static bool inside(const part_view& part, vec3 q) {
    if constexpr (solid) return part.interior.inside(q);
    return false;
  }

  /// Finds a pair's bound, and which of its two nodes is to be opened. Returns false if nothing in it matters or all of
  /// it has been looked at.
  CLEARANCE_HD bool examine(pair& p) const {
    if (p.level == 0) return look_at_point(p, tree.point(p.at));
    ball b = tree.balls[node_of(p)];
    if (!(b.radius >= 0)) return false;  // no point of it counts
    if constexpr (Tree::of_balls)
      b.radius = (b.radius + tree.widest[node_of(p)]) * (1 + slack);  // around all balls
    else if (b.radius <= bounds[p.part].most && in_one_place(p))
      return look_at_point(p, cloud_tree::numbered_point{tree.boxes[node_of(p)].lower, least(p)});
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
        bound = bounds[p.part].lower(away(node_of(p), b, x, around.center, p.part), size);
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
    const extent& box = tree.boxes[node];
    const rigid_transform& to = body.places[k].part_from_cloud;
    const vec3 d = center - to.translation;
    const vec3 w{to.row[0].x * d.x + to.row[1].x * d.y + to.row[2].x * d.z,
                 to.row[0].y * d.x + to.row[1].y * d.y + to.row[2].y * d.z,
                 to.row[0].z * d.x + to.row[1].z * d.y + to.row[2].z * d.z};
    const vec3 low = box.lower - body.origin - w, high = w - (box.upper - body.origin);
    const vec3 beyond{rough_max(rough_max(low.x, high.x), 0), rough_max(rough_max(low.y, high.y), 0),
                      rough_max(rough_max(low.z, high.z), 0)};
    real least = rough_length(beyond);
    if constexpr (Tree::of_balls) least = least - tree.widest[node] * (1 + 4 * slack);
    return rough_max(least, rough_length(x - w) - b.radius * (1 + slack));
  }

  /// Do all of a node's points get the same computed position in the part's frame? Then the point with the lowest
  /// number stands for them: equal points, and points too close together for floats there. The computed position is
  /// monotone in each coordinate, so the box's corners decide. (They do not tell the sign of a sum of 0.)
  CLEARANCE_HD bool in_one_place(const pair& p) const {
    const extent& box = tree.boxes[node_of(p)];
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
    if (solid && p.whole) return visit(here, p.part), false;
    const auto& its = body.parts[p.part].tree;
    const auto q = scan::moved(body.places[p.part].part_from_cloud, element_less(here, body.origin));
    const real near = reach(p.part), bound = scan::bound_of(its.volume(p.node), q, near);
    if (!(bound <= near)) return false;
    if (!its.is_leaf(p.node)) return p.bound = max(p.bound, bound), p.by_points = false, true;
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
    if (!frames::may_reach({place.around.center, place.around.radius + b.radius}, 0, x)) return p.whole = false, true;
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

}  // namespace clearance::plan
