// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a robot's parts are made of: primitives, volumes, a tree of them, and a solid.

#include <clearance/concepts/tangent.hpp>

#include <concepts>
#include <cstdint>
#include <span>
#include <type_traits>

namespace clearance {

/// Something stored in the leaves of a tree.
///
/// Law: `p.distance(q)` is the distance in metres from point q to the primitive; negative inside, if it has an inside.
/// Law: `p.nearest(q)` lies on the primitive, `p.distance(q)` away from q. `p.normal(q)` is the unit vector along which
/// the distance grows fastest at q, the primitive's own normal where the distance is 0, or (0,0,0) if there is none.
/// Law: the convex hull of `p.balls()` contains the primitive.
template <class P>
concept primitive = std::is_trivially_copyable_v<P> && requires(const P p, vec3 q) {
  { p.distance(q) } -> std::same_as<real>;
  { p.nearest(q) } -> std::same_as<vec3>;
  { p.normal(q) } -> std::same_as<vec3>;
  { std::span<const ball>(p.balls()) };
};

/// A primitive that also says whether it may be as near as `reach`, without a branch and more cheaply than by its
/// distance: a host asks this for many points at once, in vector code.
/// Law: `p.may_reach(q, reach)` is true if `p.distance(q) <= reach`.
template <class P>
concept foreseen_primitive = primitive<P> && requires(const P p, vec3 q, real reach) {
  { p.may_reach(q, reach) } -> std::same_as<bool>;
};

/// A primitive whose distance has one root, with all before and after it without a branch: roots do not become vector
/// code, the rest does.
/// Law: `p.distance(q)` is `before.distance(square_root(before.squared))` in every bit, with `before =
/// p.before_root(q)`.
template <class P>
concept rootless_primitive = primitive<P> && requires(const P p, vec3 q, real root) {
  { p.before_root(q).squared } -> std::convertible_to<real>;
  { p.before_root(q).distance(root) } -> std::same_as<real>;
};

/// A primitive with a quick lower bound on its distance.
/// Law: `p.lower_bound(q)` is never greater than `p.distance(q)`, rounding included.
template <class P>
concept bounded_primitive = primitive<P> && requires(const P p, vec3 q) {
  { p.lower_bound(q) } -> std::same_as<real>;
};

/// A convex primitive that bounds its distance around a point: see primitive_tangent.
template <class P>
concept tangent_primitive = primitive<P> && requires(const P p, vec3 q) {
  { p.tangent_at(q) } -> std::same_as<primitive_tangent>;
};

/// A primitive that tells its core: see core_place. Parts of such primitives can have cells (near_maps.hpp).
template <class P>
concept cored_primitive = tangent_primitive<P> && requires(const P p, vec3 q) {
  { p.core_at(q) } -> std::same_as<core_place>;
};

/// `primitive<P>` with reasons: nvcc does not say which requirement of a concept failed.
template <class P>
consteval bool explain_primitive() {
  static_assert(std::is_trivially_copyable_v<P>, "a primitive must be trivially copyable");
  static_assert(
      requires(const P p, vec3 q) {
        { p.distance(q) } -> std::same_as<real>;
      }, "a primitive needs: CLEARANCE_HD real distance(vec3) const");
  static_assert(
      requires(const P p, vec3 q) {
        { p.nearest(q) } -> std::same_as<vec3>;
      }, "a primitive needs: CLEARANCE_HD vec3 nearest(vec3) const");
  static_assert(
      requires(const P p, vec3 q) {
        { p.normal(q) } -> std::same_as<vec3>;
      }, "a primitive needs: CLEARANCE_HD vec3 normal(vec3) const");
  static_assert(
      requires(const P p) { std::span<const ball>(p.balls()); },
      "a primitive needs: balls() const, a few balls whose convex hull contains it");
  return primitive<P>;
}

/// How the library reaches a volume: by its members. Specialise for a type that you cannot change.
template <class V>
struct bounding_volume_traits {
  static V fit(std::span<const ball> balls)
    requires requires {
      { V::fit(balls) } -> std::same_as<V>;
    }
  {
    return V::fit(balls);
  }
  CLEARANCE_HD static real lower_bound(const V& v, vec3 q)
    requires requires {
      { v.lower_bound(q) } -> std::same_as<real>;
    }
  {
    return v.lower_bound(q);
  }
  /// Optional: see rootless_volume.
  CLEARANCE_HD static bool may_reach(const V& v, vec3 q, real reach)
    requires requires {
      { v.may_reach(q, reach) } -> std::same_as<bool>;
    }
  {
    return v.may_reach(q, reach);
  }
  /// Optional: see round_volume.
  CLEARANCE_HD static ball as_ball(const V& v)
    requires requires {
      { v.as_ball() } -> std::same_as<ball>;
    }
  {
    return v.as_ball();
  }
  /// Optional: see tangent_volume.
  CLEARANCE_HD static tangent tangent_at(const V& v, vec3 q)
    requires requires {
      { v.tangent_at(q) } -> std::same_as<tangent>;
    }
  {
    return v.tangent_at(q);
  }
  /// Optional: a few balls whose convex hull contains the volume. Needed by the layered fit alone.
  static auto balls(const V& v)
    requires requires { std::span<const ball>(v.balls()); }
  {
    return v.balls();
  }
};

/// Can be copied byte by byte, as to a device: trivially copyable, or the traits declare `static constexpr bool
/// bitwise_copyable = true` (as for Eigen's types, which can but do not say so).
template <class V>
concept copied_as_bytes =
    std::is_trivially_copyable_v<V> || requires { requires bounding_volume_traits<V>::bitwise_copyable; };

/// A convex shape that encloses balls and can say how far away they must be.
///
/// Law: `lower_bound(fit(balls), q)` never exceeds the signed distance from q to any of the balls, nor a primitive's
/// computed distance, after float rounding (see `lowered`). Inside the volume it is negative.
/// `fit` runs on the host while building; `lower_bound` runs wherever the query runs.
template <class V>
concept bounding_volume = copied_as_bytes<V> && requires(const V v, vec3 q, std::span<const ball> balls) {
  { bounding_volume_traits<V>::fit(balls) } -> std::same_as<V>;
  { bounding_volume_traits<V>::lower_bound(v, q) } -> std::same_as<real>;
};

/// A volume that also says whether anything in it may be as near as `reach`, without a root or a branch: a host asks
/// this for many points at once, in vector code.
///
/// Law: `may_reach(q, reach)` is true if the computed distance of a primitive in it is at most `reach`.
template <class V>
concept rootless_volume = bounding_volume<V> && requires(const V v, vec3 q, real reach) {
  { bounding_volume_traits<V>::may_reach(v, q, reach) } -> std::same_as<bool>;
};

/// A volume that is a ball. Its distance from a box then follows from that of its middle.
///
/// Law: `as_ball(v)` contains all that the volume encloses.
template <class V>
concept round_volume = bounding_volume<V> && requires(const V v) {
  { bounding_volume_traits<V>::as_ball(v) } -> std::same_as<ball>;
};

/// A volume that bounds the distance of what it encloses around a point: see tangent.
template <class V>
concept tangent_volume = bounding_volume<V> && requires(const V v, vec3 q) {
  { bounding_volume_traits<V>::tangent_at(v, q) } -> std::same_as<tangent>;
};

/// `bounding_volume<V>` with reasons: nvcc does not say which requirement of a concept failed.
template <class V>
consteval bool explain_bounding_volume() {
  static_assert(copied_as_bytes<V>, "a bounding volume must be trivially copyable");
  static_assert(
      requires(std::span<const ball> balls) {
        { bounding_volume_traits<V>::fit(balls) } -> std::same_as<V>;
      }, "a bounding volume V needs: static V fit(std::span<const ball>), as a member or in bounding_volume_traits<V>");
  static_assert(
      requires(const V v, vec3 q) {
        { bounding_volume_traits<V>::lower_bound(v, q) } -> std::same_as<real>;
      },
      "a bounding volume needs: CLEARANCE_HD real lower_bound(vec3) const, as a member or in "
      "bounding_volume_traits<V>");
  return bounding_volume<V>;
}

/// A tree of volumes over primitives, the library's or yours. Traversals use nothing else.
///
/// Law: the volume of a node encloses every primitive below it. Every primitive is below the root exactly once.
/// Law: `id` is the primitive's position in the user's array. `depth()` counts the edges from the root to the deepest
/// leaf, and `width()` is the largest number of children, so a stack needs depth * (width - 1) + 1 entries at most.
template <class H>
concept hierarchy =
    std::is_trivially_copyable_v<H> && requires(const H h, const typename H::node_type n, std::uint32_t k) {
      requires bounding_volume<typename H::volume_type>;
      requires primitive<typename H::primitive_type>;
      { h.root() } -> std::same_as<typename H::node_type>;
      { h.is_leaf(n) } -> std::same_as<bool>;
      { h.size(n) } -> std::same_as<std::uint32_t>;  // children of an inner node, primitives of a leaf
      { h.child(n, k) } -> std::same_as<typename H::node_type>;
      { h.volume(n) } -> std::convertible_to<const typename H::volume_type&>;
      { h.primitive(n, k) } -> std::convertible_to<const typename H::primitive_type&>;
      { h.id(n, k) } -> std::same_as<std::uint32_t>;
      { h.depth() } -> std::same_as<std::uint32_t>;
      { h.width() } -> std::same_as<std::uint32_t>;
    };

/// The most entries that a depth-first walk of a tree can have pending.
CLEARANCE_HD constexpr std::uint64_t stack_need(std::uint32_t depth, std::uint32_t width) {
  return width == 0 ? 1 : std::uint64_t(depth) * (width - 1) + 1;
}

template <hierarchy H>
CLEARANCE_HD std::uint64_t stack_need(const H& tree) {
  return stack_need(tree.depth(), tree.width());
}

/// `hierarchy<H>` with reasons.
template <class H>
consteval bool explain_hierarchy() {
  static_assert(std::is_trivially_copyable_v<H>, "a hierarchy must be a trivially copyable view");
  static_assert(
      requires {
        typename H::node_type;
        typename H::volume_type;
        typename H::primitive_type;
      }, "a hierarchy needs the types node_type, volume_type and primitive_type");
  static_assert(explain_bounding_volume<typename H::volume_type>() && explain_primitive<typename H::primitive_type>());
  using node = typename H::node_type;
  static_assert(
      requires(const H h) {
        { h.root() } -> std::same_as<node>;
      }, "a hierarchy needs: CLEARANCE_HD node_type root() const");
  static_assert(
      requires(const H h, const node n) {
        { h.is_leaf(n) } -> std::same_as<bool>;
        { h.size(n) } -> std::same_as<std::uint32_t>;
      },
      "a hierarchy needs: CLEARANCE_HD bool is_leaf(node_type) const and CLEARANCE_HD std::uint32_t size(node_type) "
      "const");
  static_assert(
      requires(const H h, const node n, std::uint32_t k) {
        { h.child(n, k) } -> std::same_as<node>;
      }, "a hierarchy needs: CLEARANCE_HD node_type child(node_type, std::uint32_t) const");
  static_assert(
      requires(const H h, const node n) {
        { h.volume(n) } -> std::convertible_to<const typename H::volume_type&>;
      }, "a hierarchy needs: CLEARANCE_HD const volume_type& volume(node_type) const");
  static_assert(
      requires(const H h, const node n, std::uint32_t k) {
        { h.primitive(n, k) } -> std::convertible_to<const typename H::primitive_type&>;
        { h.id(n, k) } -> std::same_as<std::uint32_t>;
      },
      "a hierarchy needs: primitive(node_type, std::uint32_t) const and std::uint32_t id(node_type, std::uint32_t) "
      "const");
  static_assert(
      requires(const H h) {
        { h.depth() } -> std::same_as<std::uint32_t>;
        { h.width() } -> std::same_as<std::uint32_t>;
      }, "a hierarchy needs: std::uint32_t depth() const and std::uint32_t width() const");
  return hierarchy<H>;
}

/// The solid of a part, besides its primitives: a view.
///
/// Law: `inside(q)` tells whether q is inside. A point inside has distance 0 to the part.
/// Law: the part's primitives bound the solid: no point of it is outside a ball around them, and every way from inside
/// to outside meets one or comes within the part's tolerance of one. So points not near the primitives need no test.
template <class I>
concept interior = std::is_trivially_copyable_v<I> && requires(const I i, vec3 q) {
  { i.inside(q) } -> std::same_as<bool>;
};

}  // namespace clearance
