// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What is asked: a small value that knows nothing about where it runs. And all that it can besides.

#include <clearance/ground/can.hpp>
#include <clearance/ground/math.hpp>

#include <concepts>
#include <cstdint>
#include <span>
#include <type_traits>

namespace clearance {

struct part_facts;
struct point_counts;
namespace frames {
struct float_error;
}

/// What a user asks: its options as members, and what the answer is. It is about pairs of a point and a part
/// (pairwise/engine.hpp), or has an engine of its own, `template <class On, class PartView> class engine`
/// (query/engine.hpp).
///
/// Law: one value gives the same `result` on every backend, to the bit. Lengths are doubles in metres; what cannot be
/// asked is refused with std::invalid_argument when it is asked.
template <class Q>
concept question = std::copy_constructible<Q> && requires { typename Q::result; };

/// A question that can be enqueued. `out` says where a backend writes its result.
template <class Q>
concept writing_question = question<Q> && requires { typename Q::out; };

/// Where the points of a piece of all clouds lie: piece point i of cloud c is point `first[c] + i` of that cloud.
struct piece_place {
  std::span<const std::uint32_t> first, count, whole;  ///< Per cloud; `whole` is how many points the cloud has.
};

/// A question that can be asked about pieces of the clouds, one after another or in several places at once.
///
/// Law: `merge(all, other)` makes `all` the result of one call about the points of both. It is associative, and it
/// does not matter which came first.
template <class Q>
concept merging_question = question<Q> && requires(typename Q::result& all, const typename Q::result& other) {
  { Q::merge(all, other) } -> std::same_as<void>;
};
CLEARANCE_ABILITY(merging, merge, merging_question,
                  "a merging question needs: static void merge(result& all, const result& other)");

/// A question whose result names points. Law: `place_in_whole(result, place)` gives a piece's points their numbers in
/// whole clouds.
template <class Q>
concept numbering_question = question<Q> && requires(typename Q::result& piece, const piece_place& place) {
  { Q::place_in_whole(piece, place) } -> std::same_as<void>;
};
CLEARANCE_ABILITY(numbering, place_in_whole, numbering_question,
                  "a numbering question needs: static void place_in_whole(result& piece, const piece_place& place)");

/// A question whose result tells something while points are unseen.
/// Law: `so_far(result, unseen)` leaves only what holds wherever the unseen points are.
template <class Q>
concept partial_question = question<Q> && requires(typename Q::result& all, std::uint64_t unseen) {
  { Q::so_far(all, unseen) } -> std::same_as<void>;
};
CLEARANCE_ABILITY(partial, so_far, partial_question,
                  "a partial question needs: static void so_far(result& all, std::uint64_t unseen)");

/// A question that can refuse what no frame could mend when a `query` is made.
template <class Q>
concept checking_question = question<Q> && (requires(const Q q, std::size_t parts) {
  { q.check(parts) } -> std::same_as<void>;
} || requires(const Q q) {
  { q.check() } -> std::same_as<void>;
});
CLEARANCE_ABILITY(checking, check, checking_question,
                  "a checking question needs: void check(std::size_t parts) const, or void check() const");

/// A question that needs only the chunks of a cloud within reach, once the host has read the whole cloud.
/// Law: no point of the part that is farther than `reach(part, parts, facts, error)` matters; `set_counts` gives a
/// result the counts of the whole cloud, and what follows of them.
template <class Q>
concept skipping_question =
    question<Q> && requires(const Q q, typename Q::result& r, const point_counts& counts, std::size_t n,
                            const part_facts& facts, const frames::float_error& error) {
      { Q::set_counts(r, counts) } -> std::same_as<void>;
      { q.reach(n, n, facts, error) } -> std::same_as<real>;
    };
CLEARANCE_ABILITY(skipping, set_counts, skipping_question,
                  "a skipping question needs: static void set_counts(result&, const point_counts&), and real "
                  "reach(std::size_t part, std::size_t parts, const part_facts&, const frames::float_error&) const");

namespace detail {
template <template <class> class>
struct takes_one;
template <template <class, class> class>
struct takes_two;
}  // namespace detail

/// A question that needs more than `merge`: `joined(question, facts)` is told `add(result, place)` for each piece, and
/// then has the `result()`. If its engine can be `bound_by` something, it also has `reach()`, how near a point must be
/// to change the result.
template <class Q>
concept joining_question = question<Q> && requires { typename detail::takes_one<Q::template joined>; };
CLEARANCE_ABILITY(joining, joined, joining_question,
                  "a joining question needs: template <class PartView> class joined");

/// A question with an engine of its own for a `chunked` cloud (minimum/chunked_search.hpp).
template <class Q>
concept chunking_question = question<Q> && requires { typename detail::takes_two<Q::template chunks>; };
CLEARANCE_ABILITY(chunking, chunks, chunking_question,
                  "a chunking question needs: template <class On, class PartView> class chunks");

/// A question about robots of some parts alone: those for which `about<PartView>` is true.
CLEARANCE_ABILITY(choosing, about, question,
                  "a choosing question needs: template <class PartView> static constexpr bool about");

/// What a list says about clouds has no member. Without it a question takes every source.
struct says_of_clouds {
  template <class Q>
  static consteval bool explain() {
    return true;
  }
};
/// In a list: the question is about depth images alone, because no other source says what it hides.
struct of_images : says_of_clouds {};
/// In a list: it is about points, not about what they hide or where they may be.
struct of_points : says_of_clouds {};
/// In a list: it is about points, and balls around them.
struct of_balls : says_of_clouds {};

/// A question about many configurations (plan/engine.hpp): poses are those of one after another. `searched` is what is
/// kept of each.
template <class Q>
concept planning_question = question<Q> && requires { typename Q::searched::result_type; };
CLEARANCE_ABILITY(planning, searched, planning_question,
                  "a planning question needs: a type searched, such as plan::least_question");

// A question about pairs (pairwise/engine.hpp). Its members know the engine's types, so they are asked for by name.

/// `conclude(asked, answer, out)` enqueues what comes after the scan.
CLEARANCE_ABILITY(
    concluding, conclude, question,
    "a concluding question needs: template <class Asked> void conclude(const Asked&, const answer&, const "
    "out&) const");
/// `more(asked, out, result)` reads the result and returns 0, or says how much room `space(asked, least)` must have.
CLEARANCE_ABILITY(retrying, more, question,
                  "a retrying question needs: template <class Asked> std::size_t more(const Asked&, const out&, "
                  "result&) const, and out space(const Asked&, std::size_t least) const");
/// `counts_of(out)` is where the counts go, instead of `out.counts`.
template <class Q>
concept counting_question = question<Q> && requires(const typename Q::out& to) {
  { Q::counts_of(to) } -> std::same_as<point_counts*>;
};
CLEARANCE_ABILITY(counting, counts_of, counting_question,
                  "a question about pairs needs: point_counts* counts in its out, or static point_counts* "
                  "counts_of(const out&)");

namespace detail {
struct own_engine {
  CLEARANCE_MEMBER(engine, "an engine of a question's own is: template <class On, class PartView> class engine")
};
struct pair_space {
  CLEARANCE_MEMBER(space, "a question needs, or an engine: template <class Asked> out space(const Asked&) const")
};
struct pair_prepare {
  CLEARANCE_MEMBER(prepare,
                   "a question needs, or an engine: template <class Asked> answer prepare(const Asked&, const out&) "
                   "const, perhaps with the clouds as a third argument")
};
struct pair_read {
  CLEARANCE_MEMBER(read,
                   "a question needs, or an engine: template <class Asked> result read(const Asked&, const out&) const")
};
}  // namespace detail

/// `question<Q>` with reasons, and why something that it can is not as it must be.
template <class Q>
consteval bool explain_question() {
  static_assert(
      requires { typename Q::result; },
      "a question needs: a type result. The arguments are: backend, robot (or part), poses, clouds, question");
  static_assert(std::copy_constructible<Q>, "a question is a value: it must be copyable");
  if constexpr (question<Q>) {
    static_assert(std::is_class_v<Q> && !std::is_final_v<Q>,
                  "a question is a class that is not final: its members are asked for by their names");
    constexpr bool can_all =
        explain_abilities<Q, merging, numbering, partial, checking, skipping, joining, chunking, choosing, of_images,
                          of_points, of_balls, planning, concluding, retrying, counting>();
    if constexpr (detail::own_engine::is_there<Q>()) {
      return can_all && detail::own_engine::needs<requires { typename detail::takes_two<Q::template engine>; }>();
    } else {
      static_assert(writing_question<Q>, "a question needs, or an engine: a type out, where a backend writes");
      return can_all && writing_question<Q> && detail::pair_space::needs<detail::pair_space::is_there<Q>()>() &&
             detail::pair_prepare::needs<detail::pair_prepare::is_there<Q>()>() &&
             detail::pair_read::needs<detail::pair_read::is_there<Q>()>();
    }
  } else {
    return false;
  }
}

}  // namespace clearance
