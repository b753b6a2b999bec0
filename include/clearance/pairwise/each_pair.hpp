// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Gives every pair to an answer once.

#include <clearance/ground/ordered.hpp>
#include <clearance/result.hpp>
#include <clearance/robot/field.hpp>
#include <clearance/visitor/nearest.hpp>

namespace clearance::pairwise {

/// A visitor for an answer that does not need the nearest primitive.
template <coarse_answer Answer>
struct near_enough {
  using result_type = nearest::result_type;

  const Answer* answer;
  std::uint32_t part;
  std::uint32_t* least;  ///< The least known distance of any pair of the part, `ordered`.
  nearest found;
  real within = found.within;

  CLEARANCE_HD real reach() const { return within; }
  CLEARANCE_HD void offer(std::uint32_t id, real distance) {
    if (!(distance <= within)) return;
    found.offer(id, distance);
    const std::uint32_t u = ordered(found.within), known = load_relaxed(least);
    if (u < known) lower_word(least, u);
    within = answer->reach(part, found.within, from_ordered(u < known ? u : known));
  }
  CLEARANCE_HD result_type result() const { return found.result(); }
};

/// An answer for `scan_body`.
template <answer Answer>
struct each_pair {
  Answer answer;
  std::uint32_t cloud, first;
  std::uint32_t* least;                ///< Per part, for an answer that asks for it.
  const field_view* fields = nullptr;  ///< One per part, or null.

  CLEARANCE_HD real reach(std::uint32_t k) const { return answer.reach(k); }
  CLEARANCE_HD real reach_of_pair(std::uint32_t index, std::uint32_t k) const {
    if constexpr (settling_answer<Answer>)
      if (answer.settled(cloud, index - first, k)) return -infinity;
    return answer.reach(k);
  }
  CLEARANCE_HD bool settled(std::uint32_t, std::uint32_t) const { return false; }
  CLEARANCE_HD bool touched(std::uint32_t, std::uint32_t) const { return false; }
  CLEARANCE_HD bool ended([[maybe_unused]] std::uint32_t index) const {
    if constexpr (ending_answer<Answer>)
      return answer.ended(cloud, index - first);
    else
      return false;
  }
  CLEARANCE_HD bool take_inside(std::uint32_t index, std::uint32_t k) const {
    if (answer.reach(k) >= 0) answer.take({cloud, index - first, k, none, 0});
    return false;
  }
  CLEARANCE_HD void take_certain() const {}
  CLEARANCE_HD auto visitor(std::uint32_t, std::uint32_t k) const {
    if constexpr (coarse_answer<Answer>)
      return near_enough<Answer>{&answer, k, least + k, {answer.reach(k)}};
    else
      return nearest{answer.reach(k)};
  }
  /// Does a field tell enough of a pair outside its part's solid? The answer has it then, if it counts. Otherwise the
  /// visitor need not look any farther than the field does.
  template <class Visitor>
  CLEARANCE_HD bool foresees(std::uint32_t index, std::uint32_t k, vec3 q, bool solid, Visitor& ask) const {
    if (fields == nullptr) return false;
    const field_range range = fields[k](q);
    if (solid && range.side != field_side::outside) return false;
    if (range.low > ask.within) return true;
    if constexpr (coarse_answer<Answer>)
      if (range.high <= ask.within) {
        const std::uint32_t u = ordered(range.high), known = load_relaxed(least + k);
        if (u < known) lower_word(least + k, u);
        if (range.low > answer.reach(k, range.high, from_ordered(u < known ? u : known))) {
          answer.take({cloud, index - first, k, none, range.high});
          return true;
        }
      }
    ask.within = min(ask.within, range.high);
    return false;
  }
  template <class Visitor>
  CLEARANCE_HD void take(std::uint32_t index, std::uint32_t k, const Visitor& walked) const {
    if (const auto found = walked.result(); found.primitive != none)
      answer.take({cloud, index - first, k, found.primitive, found.distance});
  }
};

}  // namespace clearance::pairwise
