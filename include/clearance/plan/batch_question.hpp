// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Questions about many configurations that search a tree over points. Each names an answer for `scan_body` and its
// initial value.

#include <clearance/frame/margins.hpp>
#include <clearance/minimum/shared_bounds.hpp>
#include <clearance/plan/within_margins.hpp>
#include <clearance/result.hpp>

namespace clearance::minimum {

/// The least distance up to `d_max`, and its witness.
struct least_question {
  using answer_type = shared_bounds;
  using memory_type = totals;
  using result_type = min_distance_result;
  static constexpr bool by_margin = false;

  real d_max;

  bool limited() const { return d_max < infinity; }
  CLEARANCE_HD totals start(bool rigid = true) const { return {make_key(rigid ? d_max : -infinity, none)}; }
  CLEARANCE_HD static answer_type answer(totals* all, const margin_reach*) { return {all, nullptr}; }
  /// Adds what another block has found.
  CLEARANCE_HD static void add(totals* all, const totals& found) {
    lower_to(&all->best, found.best);
    if (found.certain != 0) add_to(&all->certain, 1);
  }
};

/// Is anything nearer than the margins? One margin for all parts, or one per part.
struct margin_question {
  using answer_type = within_margins;
  using memory_type = margin_word;
  using result_type = state;
  static constexpr bool by_margin = true;

  const double* margins;
  std::uint32_t count;
  bool vague = false;  ///< No point is certainly anywhere.

  bool limited() const { return true; }
  CLEARANCE_HD margin_word start(bool = true) const { return {}; }
  CLEARANCE_HD static answer_type answer(margin_word* word, const margin_reach* near) { return {word, near}; }
  CLEARANCE_HD static void add(margin_word* word, const margin_word& found) { lower_word(&word->found, found.found); }
  CLEARANCE_HD margin_reach near(std::uint32_t k, const part_facts& facts, const frames::float_error& error) const {
    const double margin = margins[count == 1 ? 0 : k];
    return {frames::may_be_within(margin, facts, error), vague ? -infinity : frames::is_within(margin, facts, error)};
  }
  /// The state that in_collision reports for `word`.
  CLEARANCE_HD static state told(const margin_word& word, std::uint64_t valid, bool too_close) {
    if (valid == 0) return state::no_data;
    return word.found == margin_word::certain                 ? state::collision
           : word.found == margin_word::possible || too_close ? state::possible
                                                              : state::free;
  }
};

}  // namespace clearance::minimum
