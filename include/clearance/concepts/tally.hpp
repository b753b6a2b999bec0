// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a scan on one backend keeps of an answer while it runs. An answer knows points and parts; a tally also knows how
// the scan looks at them. The library makes tallies; an answer of your own needs none.

#include <clearance/concepts/traversal.hpp>

namespace clearance {

namespace detail {
template <class Visitor>
Visitor& lvalue(Visitor&&);
}  // namespace detail

/// What the loop over points (scan/scan_body.hpp) keeps. `index` is a point's number among all clouds' points.
///
/// Law: `reach(part)` never grows while the scan runs, and `reach_of_pair(index, part)` is not above it.
/// Law: if `settled(index, part)`, what is inside that part changes nothing for that point; if `touched(index, part)`,
/// neither does what touches it from outside. If `ended(index)`, nothing changes anything from that point of the cloud
/// on. If `foresees(index, part, q, solid, visitor)`, the point, at q in the part's frame, need not walk; otherwise the
/// visitor may have come nearer. `solid`: the part has an inside.
/// Law: `take_inside(index, part)` takes a point inside the part's solid, and returns whether it matters if that is
/// certain; then `take_certain()` may be called. `take(index, part, walked)` takes what `visitor(index, part)` has
/// seen. Any thread calls them, in any order.
template <class T>
concept tally = std::is_trivially_copyable_v<T> && requires(const T t, std::uint32_t n, vec3 q) {
  { t.reach(n) } -> std::same_as<real>;
  { t.reach_of_pair(n, n) } -> std::same_as<real>;
  { t.settled(n, n) } -> std::same_as<bool>;
  { t.touched(n, n) } -> std::same_as<bool>;
  { t.ended(n) } -> std::same_as<bool>;
  { t.take_inside(n, n) } -> std::same_as<bool>;
  t.take_certain();
  requires visitor<decltype(t.visitor(n, n))>;
  t.take(n, n, t.visitor(n, n));
  { t.foresees(n, n, q, true, detail::lvalue(t.visitor(n, n))) } -> std::same_as<bool>;
};

/// A tally for the search through a tree over points (plan/tree_search.hpp).
/// Law: `lower(index, part, distance)` takes the distance of one real pair. `lowest_first(part)` says that of equal
/// distances the lowest point must be found.
template <class T>
concept searching_tally = tally<T> && requires(const T t, std::uint32_t n, real distance) {
  t.lower(n, n, distance);
  { t.lowest_first(n) } -> std::same_as<bool>;
};

/// `tally<T>` with reasons.
template <class T>
consteval bool explain_tally() {
  static_assert(std::is_trivially_copyable_v<T>, "a tally must be a trivially copyable view");
  static_assert(
      requires(const T t, std::uint32_t n) {
        { t.reach(n) } -> std::same_as<real>;
        { t.reach_of_pair(n, n) } -> std::same_as<real>;
      },
      "a tally needs: real reach(std::uint32_t part) const, real reach_of_pair(std::uint32_t index, std::uint32_t "
      "part) const");
  static_assert(
      requires(const T t, std::uint32_t n) {
        { t.settled(n, n) } -> std::same_as<bool>;
        { t.touched(n, n) } -> std::same_as<bool>;
        { t.take_inside(n, n) } -> std::same_as<bool>;
        t.take_certain();
      },
      "a tally needs, for points inside a solid: bool settled(index, part), bool touched(index, part), bool "
      "take_inside(index, part), void take_certain()");
  static_assert(
      requires(const T t, std::uint32_t n) {
        { t.ended(n) } -> std::same_as<bool>;
      }, "a tally needs: bool ended(std::uint32_t index) const");
  static_assert(
      requires(const T t, std::uint32_t n, vec3 q) {
        { t.foresees(n, n, q, true, detail::lvalue(t.visitor(n, n))) } -> std::same_as<bool>;
      }, "a tally needs: bool foresees(index, part, vec3 q, bool solid, the visitor&) const");
  static_assert(
      requires(const T t, std::uint32_t n) { t.take(n, n, t.visitor(n, n)); },
      "a tally needs: a visitor visitor(index, part), and void take(index, part, const the visitor&)");
  return tally<T>;
}

}  // namespace clearance
