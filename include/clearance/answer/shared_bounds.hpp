// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/ordered.hpp>
#include <clearance/visitor/nearest.hpp>

namespace clearance::minimum {

/// Shared by all points of all clouds of a call.
struct totals {
  distance_key best = no_key;
  unsigned long long certain = 0;  ///< Not 0: some point is inside a part by more than rounding.
};

/// The visitor of the shared minimum (the paper's Algorithm 3): its reach is the best that anybody has found.
struct shared_nearest {
  using result_type = real;

  const distance_key* shared;
  real best = infinity;

  CLEARANCE_HD real reach() const { return min(best, key_distance(load_relaxed(shared))); }
  CLEARANCE_HD void offer(std::uint32_t, real distance) {
    if (distance < best) best = distance;
  }
  CLEARANCE_HD real result() const { return best; }
};
static_assert(visitor<shared_nearest>);

/// The least distance as an answer of `scan_body`: one bound for all parts, or one a part.
struct shared_bounds {
  totals* all;
  distance_key* part_best;  ///< One bound a part, or null: all parts share `all->best`.

  CLEARANCE_HD distance_key* bound_of(std::uint32_t k) const {
    return part_best != nullptr ? part_best + k : &all->best;
  }
  CLEARANCE_HD real reach(std::uint32_t k) const { return key_distance(load_relaxed(bound_of(k))); }
  CLEARANCE_HD real reach_of_pair(std::uint32_t, std::uint32_t k) const { return reach(k); }
  CLEARANCE_HD void lower(std::uint32_t index, std::uint32_t k, real distance) const {
    distance_key* const bound = bound_of(k);
    if (const distance_key key = make_key(distance, index); key < load_relaxed(bound)) lower_to(bound, key);
  }

  /// 0 is the least that a part with an interior can have: once a lower point has it for certain, nothing is left to
  /// learn.
  CLEARANCE_HD bool settled(std::uint32_t index, std::uint32_t k) const {
    return load_relaxed(bound_of(k)) <= make_key(0, index) && load_relaxed(&all->certain) != 0;
  }
  /// Where nothing can be nearer than 0 and something is, lower numbers matter before distances.
  CLEARANCE_HD bool lowest_first(std::uint32_t k) const { return reach(k) <= 0; }
  /// True: it is still to be learned whether a point is certainly inside.
  CLEARANCE_HD bool take_inside(std::uint32_t index, std::uint32_t k) const {
    lower_to(bound_of(k), make_key(0, index));
    return load_relaxed(&all->certain) == 0;
  }
  CLEARANCE_HD void take_certain() const { add_to(&all->certain, 1); }

  CLEARANCE_HD shared_nearest visitor(std::uint32_t, std::uint32_t k) const { return {bound_of(k)}; }
  CLEARANCE_HD void take(std::uint32_t index, std::uint32_t k, const shared_nearest& found) const {
    if (found.best < infinity) lower(index, k, found.best);
  }
};

}  // namespace clearance::minimum
