// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a scan reads of a source: a point, or its capsule. The same operations on both.

#include <clearance/concepts/capsule.hpp>

#include <cstddef>
#include <cstring>

namespace clearance::scan {

/// `p` is s[i].position.
template <point_source S>
CLEARANCE_HD auto element_of(const S& s, std::size_t i, vec3 p) {
  if constexpr (capsule_source<S>)
    return s.around(i, p);
  else
    return p;
}

/// The element less an origin; `x` is s[i].position less the origin. Distances are measured to this one.
template <point_source S>
CLEARANCE_HD auto element_less(const S& s, std::size_t i, vec3 x, vec3 origin) {
  if constexpr (capsule_source<S>) {
    vec3 p = x + origin;
    if constexpr (vague_source<S> || ball_source<S>)  // the radius of the place that was read
      if (!(origin == vec3{0, 0, 0})) p = s[i].position;
    const capsule c = s.around(i, p);
    return capsule{c.from - origin, c.along, c.radius};
  } else {
    return x;
  }
}

/// What a device's kernels make of a position: the same.
struct as_points {
  using element = vec3;
  static constexpr bool sight = false;
  CLEARANCE_HD vec3 operator()(std::uint32_t, vec3 p) const { return p; }
  CLEARANCE_HD vec3 less(std::uint32_t, vec3 x, vec3) const { return x; }
};
/// A copy of the source, as bytes: arguments of a kernel are made before they are filled, and a source may have no
/// empty state.
template <capsule_source S>
class as_capsules {
 public:
  using element = capsule;
  static constexpr bool sight = sight_source<S>;

  as_capsules() = default;
  explicit as_capsules(const S& source) { std::memcpy(bytes_, &source, sizeof source); }
  CLEARANCE_HD capsule operator()(std::uint32_t i, vec3 p) const { return source().around(i, p); }
  CLEARANCE_HD capsule less(std::uint32_t i, vec3 x, vec3 origin) const { return element_less(source(), i, x, origin); }

 private:
  CLEARANCE_HD const S& source() const { return *reinterpret_cast<const S*>(bytes_); }

  alignas(S) std::byte bytes_[sizeof(S)];
};
template <point_source S>
auto elements_of(const S& source) {
  if constexpr (capsule_source<S>)
    return as_capsules<S>(source);
  else
    return as_points{};
}

template <bounding_volume V>
CLEARANCE_HD real bound_of(const V& v, vec3 q, real) {
  return bounding_volume_traits<V>::lower_bound(v, q);
}
template <bounding_volume V>
CLEARANCE_HD real bound_of(const V& v, const capsule& q, real reach) {
  return lower_bound(v, q, reach);
}
/// A primitive's distance if it may be within reach; else anything farther.
template <primitive P>
CLEARANCE_HD real distance_of(const P& primitive, vec3 q, real) {
  return primitive.distance(q);
}
template <primitive P>
CLEARANCE_HD real distance_of(const P& primitive, const capsule& q, real reach) {
  return may_reach(primitive, q, reach) ? distance_to(primitive, q) : infinity;
}

CLEARANCE_HD inline vec3 start_of(vec3 p) { return p; }
CLEARANCE_HD inline vec3 start_of(const capsule& c) { return c.from; }

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

/// Shows a visitor a primitive,
template <primitive P, visitor Q>
CLEARANCE_HD void offer_for(std::uint32_t id, const P& primitive, vec3 q, Q& ask) {
  if constexpr (requires { ask.offer(id, real(0), primitive); })
    ask.offer(id, primitive.distance(q), primitive);
  else
    ask.offer(id, primitive.distance(q));
}
template <primitive P, visitor Q>
CLEARANCE_HD void offer_for(std::uint32_t id, const P& primitive, const capsule& q, Q& ask) {
  of_capsule<Q>{ask, q}.offer(id, 0, primitive);
}
/// Offers the primitives of a leaf.
template <hierarchy H, visitor Q>
CLEARANCE_HD void offer_leaf_for(const H& tree, const typename H::node_type leaf, vec3 q, Q& ask) {
  offer_leaf(tree, leaf, q, ask);
}
template <hierarchy H, visitor Q>
CLEARANCE_HD void offer_leaf_for(const H& tree, const typename H::node_type leaf, const capsule& q, Q& ask) {
  of_capsule<Q> about{ask, q};
  offer_leaf(tree, leaf, q.from, about);
}

}  // namespace clearance::scan
