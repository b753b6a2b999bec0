// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What is asked about one tree and one point (visitor), and what walks the tree (traversal).

#include <clearance/concepts/tree.hpp>

#include <cstddef>
#include <stdexcept>
#include <string>

namespace clearance {

/// What a traversal shows primitives to. One object per point and walk, which starts as a copy of the user's.
///
/// Law: `reach()` never grows. An offer farther than `reach()` leaves `result()` unchanged.
/// Law: the order of offers does not matter. Of equally distant ones the lowest id wins.
template <class Q>
concept visitor = requires(Q q, const Q c, std::uint32_t id, real distance) {
  typename Q::result_type;
  { c.reach() } -> std::same_as<real>;
  q.offer(id, distance);
  { c.result() } -> std::same_as<typename Q::result_type>;
};

/// `visitor<Q>` with reasons.
template <class Q>
consteval bool explain_visitor() {
  static_assert(requires { typename Q::result_type; }, "a visitor needs: a type result_type");
  static_assert(
      requires(const Q q) {
        { q.reach() } -> std::same_as<real>;
      }, "a visitor needs: CLEARANCE_HD real reach() const");
  static_assert(
      requires(Q q, std::uint32_t id, real distance) { q.offer(id, distance); },
      "a visitor needs: CLEARANCE_HD void offer(std::uint32_t id, real distance)");
  static_assert(
      requires(const Q q) {
        { q.result() } -> std::same_as<typename Q::result_type>;
      }, "a visitor needs: CLEARANCE_HD result_type result() const");
  return visitor<Q>;
}

/// Shows a visitor every primitive of a leaf: the only place where a traversal meets a primitive. A visitor that wants
/// the primitive itself takes `offer(id, distance, primitive)`.
template <hierarchy H, visitor Q>
CLEARANCE_HD void offer_leaf(const H& tree, const typename H::node_type n, vec3 p, Q& q) {
  const std::uint32_t size = tree.size(n);
  for (std::uint32_t k = 0; k < size; ++k) {
    const typename H::primitive_type& primitive = tree.primitive(n, k);
    if constexpr (requires { q.offer(0u, real(0), primitive); })
      q.offer(tree.id(n, k), primitive.distance(p), primitive);
    else
      q.offer(tree.id(n, k), primitive.distance(p));
  }
}

/// How near anything in a volume can be: its lower bound, or what a visitor's own `bound(volume, p)` says. Such a
/// visitor measures something other than the distance, and its law is a traversal's: no offer from within the volume
/// would be nearer.
template <bounding_volume V, visitor Q>
CLEARANCE_HD real bound_for(const Q& q, const V& volume, vec3 p) {
  if constexpr (requires { q.bound(volume, p); })
    return q.bound(volume, p);
  else
    return bounding_volume_traits<V>::lower_bound(volume, p);
}

/// Walks a hierarchy for one point.
///
/// Law: shows the visitor each primitive that is no farther from the point than `reach()` at that moment. Strict >
/// prunes, so ties are shown; NaN prunes.
template <class T, class H, class Q>
concept traversal = std::is_trivially_copyable_v<T> && hierarchy<H> && visitor<Q> &&
                    requires(const T walk, const H h, vec3 p, Q q) { walk(h, p, q); };

/// `traversal<T, H, Q>` with reasons.
template <class T, hierarchy H, visitor Q>
consteval bool explain_traversal() {
  static_assert(std::is_trivially_copyable_v<T>, "a traversal must be trivially copyable");
  static_assert(
      requires(const T walk, const H h, vec3 p, Q q) { walk(h, p, q); },
      "a traversal of the robot's trees needs: template <hierarchy H, visitor Q> CLEARANCE_HD void operator()(const H& "
      "tree, vec3 p, Q& q) const");
  return traversal<T, H, Q>;
}

/// A traversal with a stack of `capacity` entries. Trees that need more are refused before it starts.
template <class T>
concept bounded_traversal = requires {
  { T::capacity } -> std::convertible_to<std::uint64_t>;
};
/// Refuses a tree that is too deep for a traversal's stack, which would have to drop nodes. Throws
/// std::invalid_argument.
template <class Traversal>
void check_stack(std::uint32_t depth, std::uint32_t width) {
  if constexpr (bounded_traversal<Traversal>)
    if (stack_need(depth, width) > Traversal::capacity)
      throw std::invalid_argument(
          "clearance: a tree of depth " + std::to_string(depth) + " and width " + std::to_string(width) +
          " needs a stack of " + std::to_string(stack_need(depth, width)) + " entries, but this traversal has " +
          std::to_string(Traversal::capacity) + "; give it a larger capacity or use the recursive one");
}

/// A recursive traversal. `device_stack(depth)` is the cudaLimitStackSize that a launch needs, in bytes.
template <class T>
concept recursing_traversal = requires(std::uint32_t depth) {
  { T::device_stack(depth) } -> std::same_as<std::size_t>;
};

}  // namespace clearance
