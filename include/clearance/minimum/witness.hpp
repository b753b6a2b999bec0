// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The witness of a pair: the place on a part that is nearest to a point.

#include <clearance/ground/pose.hpp>
#include <clearance/result.hpp>
#include <clearance/scan/element.hpp>
#include <clearance/scan/interior.hpp>

namespace clearance::minimum {

/// The closest primitive itself; of equally close ones the one with the lowest id.
template <primitive P>
struct nearest_primitive {
  using result_type = std::uint32_t;

  real within;
  std::uint32_t id = none;
  P primitive = {};

  CLEARANCE_HD real reach() const { return within; }
  CLEARANCE_HD void offer(std::uint32_t, real) {}
  CLEARANCE_HD void offer(std::uint32_t i, real distance, const P& p) {
    if (distance < within || (distance == within && i < id)) within = distance, id = i, primitive = p;
  }
  CLEARANCE_HD std::uint32_t result() const { return id; }
};

/// In world coordinates.
struct contact {
  position nearest;
  vec3 normal;
};

/// The contact of a primitive with the point q, in the part's frame. `inside` a solid the normal is reversed: the way
/// out is towards the surface.
template <primitive P>
CLEARANCE_HD contact contact_of(const P& primitive, vec3 q, bool inside, const world_transform& world_from_part) {
  const vec3 away = primitive.normal(q);
  return {world_from_part(primitive.nearest(q)), world_from_part.turned(inside ? -away : away)};
}

/// A point's distance to a part, and the part's nearest primitive.
template <primitive P>
struct nearest_of_part {
  real distance;
  bool inside;
  nearest_primitive<P> nearest;

  CLEARANCE_HD contact at(vec3 q, const world_transform& world_from_part) const {
    return contact_of(nearest.primitive, q, inside && nearest.within > 0, world_from_part);
  }
};

/// The distance of a point or capsule by the scan's rule: 0 inside, else that of the closest primitive, if it is at
/// most `within`.
template <class PartView, class Element, class Traversal>
CLEARANCE_HD auto evaluate(const PartView& part, const Element& q, real within, const Traversal& walk) {
  nearest_of_part<typename PartView::hierarchy_type::primitive_type> f{infinity, false, {within}};
  if constexpr (scan::has_interior<PartView>) {
    f.inside = part.interior.inside(scan::start_of(q));
    if (f.inside) f.nearest.within = infinity;
  }
  scan::walk_for(walk, part.tree, q, f.nearest);
  if (f.nearest.id != none) f.distance = f.inside ? 0 : f.nearest.within;
  return f;
}

}  // namespace clearance::minimum
