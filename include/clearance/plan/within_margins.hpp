// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/concepts.hpp>
#include <clearance/ground/ordered.hpp>

namespace clearance::minimum {

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
  CLEARANCE_HD bool lowest_first(std::uint32_t) const { return false; }
  CLEARANCE_HD bool take_inside(std::uint32_t, std::uint32_t k) const { return lower(0, k, 0), false; }
  CLEARANCE_HD void take_certain() const {}
};

}  // namespace clearance::minimum
