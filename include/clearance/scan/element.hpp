// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a scan reads of a source: a point, or its capsule. The same operations on both.

#include <clearance/concepts/capsule.hpp>

namespace clearance::scan {

/// `p` is s[i].position.
template <point_source S>
CLEARANCE_HD auto element_of(const S& s, std::size_t i, vec3 p) {
  if constexpr (capsule_source<S>)
    return s.around(i, p);
  else
    return p;
}

CLEARANCE_HD inline vec3 start_of(vec3 p) { return p; }
CLEARANCE_HD inline vec3 start_of(const capsule& c) { return c.from; }

CLEARANCE_HD inline vec3 less(vec3 p, vec3 origin) { return p - origin; }
CLEARANCE_HD inline capsule less(const capsule& c, vec3 origin) { return {c.from - origin, c.along, c.radius}; }

CLEARANCE_HD inline vec3 moved(const rigid_transform& to, vec3 p) { return to(p); }
CLEARANCE_HD inline capsule moved(const rigid_transform& to, const capsule& c) {
  const rigid_transform turn{{to.row[0], to.row[1], to.row[2]}, {0, 0, 0}};
  return {to(c.from), turn(c.along), c.radius};
}

/// Which of the element's places is nearest to a primitive, as a share of its way.
template <primitive P>
CLEARANCE_HD real share_near(const P&, vec3) {
  return 0;
}
template <primitive P>
CLEARANCE_HD real share_near(const P& primitive, const capsule& c) {
  return primitive.least_along(c.from, c.along);
}
CLEARANCE_HD inline vec3 place_at(vec3 p, real) { return p; }
CLEARANCE_HD inline vec3 place_at(const capsule& c, real share) { return c.at(share); }

/// Shows a visitor the primitives of a tree that are within its reach.
template <class Walk, hierarchy H, visitor Q>
CLEARANCE_HD void walk_for(const Walk& walk, const H& tree, vec3 q, Q& ask) {
  walk(tree, q, ask);
}
template <class Walk, hierarchy H, visitor Q>
CLEARANCE_HD void walk_for(const Walk& walk, const H& tree, const capsule& q, Q& ask) {
  of_capsule<Q> about{ask, q};
  walk(tree, q.from, about);
}

}  // namespace clearance::scan
