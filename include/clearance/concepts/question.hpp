// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What is asked: a small value that knows nothing about where it runs.

#include <concepts>
#include <cstdint>
#include <span>
#include <type_traits>

namespace clearance {

/// What a user asks: its options as members, and what the answer is.
///
/// Law: one value gives the same `result` on every backend, to the bit. Lengths are doubles in metres; what cannot be
/// asked is refused with std::invalid_argument when it is asked. Optional: `check(parts)` or `check()` refuses what no
/// frame could mend when a `query` is made.
template <class Q>
concept question = std::copy_constructible<Q> && requires { typename Q::result; };

/// Where the points of a piece of all clouds lie: piece point i of cloud c is point `first[c] + i` of that cloud.
struct piece_place {
  std::span<const std::uint32_t> first, count, whole;  ///< Per cloud; `whole` is how many points the cloud has.
};

/// A question that can be asked about pieces of the clouds, one after another or in several places at once.
///
/// Law: `merge(all, other)` makes `all` the result of one call about the points of both. It is associative, and it
/// does not matter which came first. `place_in_whole(result, place)` gives points their numbers in whole clouds.
template <class Q>
concept merging_question =
    question<Q> && requires(typename Q::result& all, const typename Q::result& other) { Q::merge(all, other); };

/// A question whose result tells something while points are unseen.
/// Law: `so_far(result, unseen)` leaves only what holds wherever the unseen points are.
template <class Q>
concept partial_question =
    question<Q> && requires(typename Q::result& all, std::uint64_t unseen) { Q::so_far(all, unseen); };

/// `question<Q>` with reasons.
template <class Q>
consteval bool explain_question() {
  static_assert(
      requires { typename Q::result; },
      "a question needs: a type result. The arguments are: backend, robot (or part), poses, clouds, question");
  static_assert(std::copy_constructible<Q>, "a question is a value: it must be copyable");
  return question<Q>;
}

}  // namespace clearance
