// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What is asked of each of many configurations: its least distance, or whether anything is within margins.

#include <clearance/concepts.hpp>
#include <clearance/frames/margins.hpp>
#include <clearance/ground/ordered.hpp>
#include <clearance/minimum/resolve.hpp>
#include <clearance/result.hpp>

namespace clearance::plan {

// Is anything within margins?

/// Limits on computed distances: up to `may_be` a point may be within the part's margin; up to `is` it certainly is.
struct margin_reach {
  real may_be, is;
};

/// What is known of a configuration's points and margins. A smaller value is a stronger finding.
struct margin_word {
  static constexpr std::uint32_t certain = 0, possible = 1, nothing = 2;

  std::uint32_t found = nothing;
};

/// A part's visitor. It publishes what it is offered at once.
struct near_margin {
  using result_type = bool;

  margin_word* word;
  margin_reach near;

  CLEARANCE_HD std::uint32_t found() const { return load_relaxed(&word->found); }
  CLEARANCE_HD real reach() const {
    const std::uint32_t now = found();
    return now == margin_word::nothing ? near.may_be : now == margin_word::possible ? near.is : -infinity;
  }
  CLEARANCE_HD void offer(std::uint32_t, real distance) const {
    const std::uint32_t its = distance <= near.is       ? margin_word::certain
                              : distance <= near.may_be ? margin_word::possible
                                                        : margin_word::nothing;
    if (its < found()) lower_word(&word->found, its);
  }
  CLEARANCE_HD bool result() const { return found() == margin_word::certain; }
};
static_assert(visitor<near_margin>);

/// An answer of `scan_body`: is anything within margins? After a certain hit nothing more is looked at. After a
/// possible hit, only a certain hit can change the result. So the result does not depend on what was found first.
struct within_margins {
  margin_word* word;
  const margin_reach* margins;  ///< One per part.

  CLEARANCE_HD near_margin visitor(std::uint32_t, std::uint32_t k) const { return {word, margins[k]}; }
  CLEARANCE_HD void take(std::uint32_t, std::uint32_t, const near_margin&) const {}
  CLEARANCE_HD real reach(std::uint32_t k) const { return visitor(0, k).reach(); }
  CLEARANCE_HD real reach_of_pair(std::uint32_t, std::uint32_t k) const { return reach(k); }
  CLEARANCE_HD void lower(std::uint32_t, std::uint32_t k, real distance) const { visitor(0, k).offer(0, distance); }
  CLEARANCE_HD bool settled(std::uint32_t, std::uint32_t k) const { return visitor(0, k).result(); }
  CLEARANCE_HD bool touched(std::uint32_t, std::uint32_t) const { return false; }
  CLEARANCE_HD bool ended(std::uint32_t) const { return false; }
  CLEARANCE_HD bool foresees(std::uint32_t, std::uint32_t, vec3, bool, const near_margin&) const { return false; }
  CLEARANCE_HD bool lowest_first(std::uint32_t) const { return false; }
  CLEARANCE_HD bool take_inside(std::uint32_t, std::uint32_t k) const {
    lower(0, k, 0);
    return false;
  }
  CLEARANCE_HD void take_certain() const {}
};

// What an engine asks. Each names an answer for `scan_body`, its memory per configuration, and the result.

/// A configuration's minima of parts, if they decide what is certain, and how much farther each is looked for; or null.
struct of_parts {
  distance_key* best = nullptr;
  const real* extra = nullptr;
};

/// Where a configuration's last minimum was. The next search begins there, which only makes it faster.
struct last_place {
  std::uint32_t cloud = none, point = none;
};

/// The least distance up to `d_max`, and its witness.
struct least_question {
  using answer_type = minimum::shared_bounds;
  using memory_type = minimum::totals;
  using result_type = min_distance_result;
  static constexpr bool by_margin = false;

  real d_max = infinity;

  bool limited() const { return d_max < infinity; }
  CLEARANCE_HD minimum::totals start(bool rigid = true) const { return {make_key(rigid ? d_max : -infinity, none)}; }
  CLEARANCE_HD static answer_type answer(minimum::totals* all, const margin_reach*, const of_parts& own) {
    return {all, own.best, own.extra};
  }
  /// Adds what another block has found.
  CLEARANCE_HD static void add(minimum::totals* all, const minimum::totals& found) {
    lower_to(&all->best, found.best);
    if (found.certain != 0) add_to(&all->certain, 1);
  }
  /// Completes a configuration's result, which has its witness, after the last cloud. `seen`: points of all clouds.
  template <class PartView>
  CLEARANCE_HD void conclude(min_distance_result& r, const PartView* parts, std::uint32_t part_count,
                             const scan::drop_counts* dropped, minimum::totals* all, const of_parts& own,
                             const frames::frame_facts& facts, std::uint64_t seen) const {
    minimum::conclude_body<PartView>{.parts = parts,
                                     .part_count = part_count,
                                     .counts = dropped,
                                     .bounds = answer(all, nullptr, own),
                                     .error = facts.error,
                                     .slop = facts.slop,
                                     .seen = seen,
                                     .result = &r}(0);
    frames::beyond(r, d_max, facts.slop, facts.error);
  }
};

/// Is anything nearer than the margins? One margin for all parts, or one per part.
struct margin_question {
  using answer_type = within_margins;
  using memory_type = margin_word;
  using result_type = state;
  static constexpr bool by_margin = true;

  const double* margins = nullptr;
  std::uint32_t count = 0;
  bool vague = false;  ///< No point is certainly anywhere.

  bool limited() const { return true; }
  CLEARANCE_HD margin_word start(bool = true) const { return {}; }
  CLEARANCE_HD static answer_type answer(margin_word* word, const margin_reach* near, const of_parts&) {
    return {word, near};
  }
  CLEARANCE_HD static void add(margin_word* word, const margin_word& found) { lower_word(&word->found, found.found); }
  CLEARANCE_HD margin_reach near(std::uint32_t k, const part_facts& facts, const frames::float_error& error) const {
    const double margin = margins[count == 1 ? 0 : k];
    return {frames::may_be_within(margin, facts, error), vague ? -infinity : frames::is_within(margin, facts, error)};
  }
  /// The state that in_collision reports for `word`. `seen`: points of all clouds.
  CLEARANCE_HD static state told(const margin_word& word, const scan::drop_counts& dropped, std::uint64_t seen) {
    point_counts counts;
    scan::count(counts, dropped.dropped, seen);
    if (counts.valid == 0) return state::no_data;
    const bool too_close = counts.dropped[int(drop_reason::too_close)] != 0;
    return word.found == margin_word::certain                 ? state::collision
           : word.found == margin_word::possible || too_close ? state::possible
                                                              : state::free;
  }
};

}  // namespace clearance::plan
