// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What is asked about one tree and one point (visitor) and about all pairs of a point and a part (answer), and what
// walks the tree (traversal).

#include <clearance/concepts/tree.hpp>

#include <cstddef>

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

/// A pair of a point and a part, and their distance.
struct pair_distance {
  std::uint32_t cloud, point;  ///< The point's number as in its cloud.
  std::uint32_t part;
  std::uint32_t
      primitive;  ///< The part's nearest; of equally near ones the lowest. ~0u: the point is inside the part's solid.
  real distance;
};

/// What is kept of all pairs (point, part) of a frame: a view of memory that the scan's backend writes.
///
/// Law: `reach(part)` is how near the part must be to a point for the pair to matter. It never grows while a scan runs;
/// an old value only costs time.
/// Law: `take(pair)` is called once for every pair that is within reach, and perhaps for pairs that were so before. Any
/// thread may call it, in any order; the result must not depend on that.
template <class A>
concept answer = std::is_trivially_copyable_v<A> && requires(const A a, std::uint32_t part, const pair_distance pair) {
  { a.reach(part) } -> std::same_as<real>;
  a.take(pair);
};

/// An answer that can do without some pairs, which are then not looked at any further.
/// Law: `settled(cloud, point, part)` means that `take` of that pair would change nothing. Once true, it stays true
/// while a scan runs.
template <class A>
concept settling_answer = answer<A> && requires(const A a, std::uint32_t n) {
  { a.settled(n, n, n) } -> std::same_as<bool>;
};

/// A settling answer that tells when all later points are settled, too. A host then only counts them.
/// Law: `ended(cloud, point)` means that every pair of that point, and of those after it in that cloud, is settled.
template <class A>
concept ending_answer = settling_answer<A> && requires(const A a, std::uint32_t n) {
  { a.ended(n, n) } -> std::same_as<bool>;
};

/// An answer that needs only the range of a pair's distance, so that a walk may stop early.
/// Law: `reach(part, found, nearest)` is how near another primitive must be to matter to a pair that has one at
/// `found`, if some pair of the part is no farther than `nearest`. It never grows as those fall. `take` may get a
/// primitive that is not the pair's nearest, if no nearer one is within that reach.
template <class A>
concept coarse_answer = answer<A> && requires(const A a, std::uint32_t part, real d) {
  { a.reach(part, d, d) } -> std::same_as<real>;
};

/// `answer<A>` with reasons.
template <class A>
consteval bool explain_answer() {
  static_assert(std::is_trivially_copyable_v<A>, "an answer must be a trivially copyable view");
  static_assert(
      requires(const A a, std::uint32_t part) {
        { a.reach(part) } -> std::same_as<real>;
      }, "an answer needs: CLEARANCE_HD real reach(std::uint32_t part) const");
  static_assert(
      requires(const A a, const pair_distance pair) { a.take(pair); },
      "an answer needs: CLEARANCE_HD void take(const pair_distance&) const");
  return answer<A>;
}

/// Walks a hierarchy for one point.
///
/// Law: shows the visitor each primitive that is no farther from the point than `reach()` at that moment. Strict >
/// prunes, so ties are shown; NaN prunes.
template <class T, class H, class Q>
concept traversal = std::is_trivially_copyable_v<T> && hierarchy<H> && visitor<Q> &&
                    requires(const T walk, const H h, vec3 p, Q q) { walk(h, p, q); };

/// A traversal with a stack of `capacity` entries. Trees that need more are refused before it starts.
template <class T>
concept bounded_traversal = requires {
  { T::capacity } -> std::convertible_to<std::uint64_t>;
};
/// A recursive traversal. `device_stack(depth)` is the cudaLimitStackSize that a launch needs, in bytes.
template <class T>
concept recursing_traversal = requires(std::uint32_t depth) {
  { T::device_stack(depth) } -> std::same_as<std::size_t>;
};

}  // namespace clearance
