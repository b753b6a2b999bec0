// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What is kept of all pairs of a point and a part.

#include <clearance/concepts/tree.hpp>
#include <clearance/ground/can.hpp>

namespace clearance {

/// A pair of a point and a part, and their distance.
struct pair_distance {
  std::uint32_t cloud;      ///< The number of the point's cloud.
  std::uint32_t point;      ///< The number of the point in its cloud.
  std::uint32_t part;       ///< The number of the part.
  std::uint32_t primitive;  ///< The nearest primitive of the part; of equally near ones the lowest. ~0u: the point is
                            ///< inside the part's solid.
  real distance;            ///< Metres, as computed.
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
CLEARANCE_ABILITY(settling, settled, settling_answer,
                  "a settling answer needs: CLEARANCE_HD bool settled(std::uint32_t cloud, std::uint32_t point, "
                  "std::uint32_t part) const");

/// A settling answer that tells when all later points are settled, too. A host then only counts them.
/// Law: `ended(cloud, point)` means that every pair of that point, and of those after it in that cloud, is settled.
template <class A>
concept ending_answer = settling_answer<A> && requires(const A a, std::uint32_t n) {
  { a.ended(n, n) } -> std::same_as<bool>;
};
CLEARANCE_ABILITY(ending, ended, ending_answer,
                  "an ending answer needs, beside settled: CLEARANCE_HD bool ended(std::uint32_t cloud, std::uint32_t "
                  "point) const");

/// An answer that needs only the range of a pair's distance, so that a walk may stop early.
/// Law: `reach(part, found, nearest)` is how near another primitive must be to matter to a pair that has one at
/// `found`, if some pair of the part is no farther than `nearest`. It never grows as those fall. `take` may get the
/// distance of a primitive that is not the pair's nearest, if no nearer one is within that reach; or, from a field, an
/// upper bound on the least distance, with `none` as its primitive.
template <class A>
concept coarse_answer = answer<A> && requires(const A a, std::uint32_t part, real d) {
  { a.reach(part, d, d) } -> std::same_as<real>;
};
/// Its member is a second one of that name.
struct coarse {
  template <class A>
  static consteval bool explain() {
    constexpr bool listed = lists<A, coarse>,
                   there = requires(const A a, std::uint32_t part, real d) { a.reach(part, d, d); };
    static_assert(listed || !there || !has_list<A>,
                  "there is a second member reach, but the list can<...> does not name coarse");
    static_assert(coarse_answer<A> || !(there || listed),
                  "a coarse answer needs, beside reach(part): CLEARANCE_HD real reach(std::uint32_t part, real found, "
                  "real nearest) const");
    return coarse_answer<A> || !(there || listed);
  }
};

/// An answer that also meets every point, on a backend whose scan does: it has labels, one byte each, and counts those
/// that are `own` and `uncertain`.
/// Law: `whose_alone(valid)` is the label of a point that is near no part. A pair that `is_late` is taken after the
/// others of its point.
template <class A>
concept labelling_answer = answer<A> && requires(const A a, const pair_distance pair, std::uint32_t n) {
  *a.label_of(n, n) = a.whose_alone(true);
  { a.is_late(pair) } -> std::same_as<bool>;
  a.counts->own, a.counts->uncertain;
};
CLEARANCE_ABILITY(labelling, label_of, labelling_answer,
                  "a labelling answer needs: label_of(cloud, point), whose_alone(bool valid), bool is_late(const "
                  "pair_distance&), and counts with own and uncertain");

/// `answer<A>` with reasons, and why something that it can is not as it must be.
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
  if constexpr (answer<A>) return explain_abilities<A, settling, ending, coarse, labelling>();
  return false;
}

}  // namespace clearance
