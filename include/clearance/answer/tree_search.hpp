// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance of one configuration by branch and bound down a tree over the points.

#include <clearance/answer/shared_bounds.hpp>
#include <clearance/cloud_tree/tree_view.hpp>
#include <clearance/result.hpp>
#include <clearance/scan/scan_body.hpp>

namespace clearance::minimum {

/// What a part's distance to a ball of points can be, from its distance to the ball's middle: no point is nearer or farther by more
/// than the radius, and what is computed less than exactly, at both ends.
struct ball_bounds {
  real most;  ///< What arithmetic can cost at distance 0.

  ball_bounds() = default;
  /// Twice what it takes: either end is off by at most `unit_error` of twice the part's extent, that distance, and the radius.
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

/// One configuration's parts in one cloud, and a tree over its points. `Body` is a scan_body, whose answer is `shared_bounds`.
template <class Body, class Tree>
struct tree_search {
  using part_view = std::remove_cvref_t<decltype(*std::declval<Body>().parts)>;

  const Body& body;
  const Tree& tree;
  const ball_bounds* bounds;  ///< One a part.

  /// How near the robot must be.
  CLEARANCE_HD real reach() const { return body.answer.reach(0); }

  /// Is a node's ball within reach of part k's?
  CLEARANCE_HD bool may_reach(const ball& b, std::uint32_t k) const {
    const ball& around = body.places[k].around;
    return frames::may_reach({around.center, around.radius + b.radius}, reach(), b.center - body.origin);
  }

  /// How near a node's points can be to part k at least; infinite, if they do not matter. Some point is as near as the middle's
  /// distance and the radius say: so the bound falls before a point is looked at.
  CLEARANCE_HD real look(const ball& b, std::uint32_t k) const {
    const vec3 x = b.center - body.origin;
    const frames::placement& place = body.places[k];
    const part_view& part = body.parts[k];
    real least = lowered(length(x - place.around.center) - place.around.radius - b.radius, place.around.radius + b.radius);
    if (b.radius < part.facts.radius) {  // else the ball around the part says as much
      const vec3 q = place.part_from_cloud(x);
      if (!inside(part, q)) {
        nearest near{bounds[k].within(reach(), b.radius)};
        body.walk(part.tree, q, near);
        if (near.best == nearest::none) return infinity;
        if (const real most = bounds[k].upper(near.within, b.radius); most < reach()) body.answer.lower(none, k, most);
        least = bounds[k].lower(near.within, b.radius);
      }
    }
    return least <= reach() ? least : infinity;
  }

  /// Of two nodes that with the nearer points goes first. A part with an interior has nothing nearer than 0: there it is the one with the
  /// lowest number.
  CLEARANCE_HD static distance_key order(real bound, std::uint32_t least) {
    return scan::has_interior<part_view> ? make_key(max(bound, 0), least) : make_key(bound, 0);
  }

  /// May what is in a ball around `center`, below a node that is not nearer than `bound`, be within reach? The node's middle was that
  /// far away and its radius more, and every step towards it comes no nearer than its length.
  CLEARANCE_HD bool may_reach(const ball& node, real bound, vec3 center, real radius) const {
    return !(bound + node.radius - cloud_tree::rough_length_up(center - node.center) - radius > reach());
  }

  /// Is there nothing left to learn from points numbered `first_number` and higher, that are not nearer than `bound`?
  CLEARANCE_HD bool settled(real bound, std::uint32_t first_number) const {
    if (!(bound <= reach())) return true;
    if constexpr (scan::has_interior<part_view>) return body.answer.settled(body.first + first_number, 0);
    return false;
  }

  CLEARANCE_HD void visit(const cloud_tree::numbered_point& p, std::uint32_t k) const { body.visit(p.at - body.origin, body.first + p.number, k); }

 private:
  CLEARANCE_HD static bool inside(const part_view& part, vec3 q) {
    if constexpr (scan::has_interior<part_view>) return part.interior.inside(q);
    return false;
  }
};

}  // namespace clearance::minimum
