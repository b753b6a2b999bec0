// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What threads share while they look for the least distance: the best so far, of all parts or of each.

#include <clearance/frames/bracket.hpp>
#include <clearance/ground/ordered.hpp>
#include <clearance/visitor/nearest.hpp>

namespace clearance::minimum {

/// What all points of all clouds of a call share.
struct totals {
  distance_key best = no_key;
  unsigned long long certain = 0;  ///< Not 0 if some point is inside a part by more than rounding.
};

/// The visitor of the shared minimum (the paper's Algorithm 3). Its reach is the best that any point has found, and the
/// part's extra.
struct shared_nearest {
  using result_type = real;

  const distance_key* shared;
  real extra = 0;
  real best = infinity;

  CLEARANCE_HD real reach() const { return min(best, frames::farther(key_distance(load_relaxed(shared)), extra)); }
  CLEARANCE_HD void offer(std::uint32_t, real distance) {
    if (distance < best) best = distance;
  }
  CLEARANCE_HD real result() const { return best; }
};
static_assert(visitor<shared_nearest>);

/// The least distance as an answer of `scan_body`: one bound for all parts, or one per part.
struct shared_bounds {
  totals* all;
  distance_key* part_best;      ///< One bound per part, or null: all parts share `all->best`.
  const real* extra = nullptr;  ///< Not null: they do, and each is looked for so much farther (`extra_reaches`), so
                                ///< that `part_best` has what decides the bracket.

  CLEARANCE_HD bool bound_per_part() const { return part_best != nullptr && extra == nullptr; }
  CLEARANCE_HD distance_key* bound_of(std::uint32_t k) const { return bound_per_part() ? part_best + k : &all->best; }
  CLEARANCE_HD real extra_of(std::uint32_t k) const { return extra != nullptr ? extra[k] : 0; }
  CLEARANCE_HD real reach(std::uint32_t k) const {
    return frames::farther(key_distance(load_relaxed(bound_of(k))), extra_of(k));
  }
  CLEARANCE_HD real reach_of_pair(std::uint32_t, std::uint32_t k) const { return reach(k); }
  CLEARANCE_HD void lower(std::uint32_t index, std::uint32_t k, real distance) const {
    lower_key(k, make_key(distance, index));
  }

  /// A part with an interior has no distance below 0. Once a lower point has 0, and some point is certainly inside,
  /// nothing is left to learn.
  CLEARANCE_HD bool settled(std::uint32_t index, std::uint32_t k) const {
    return load_relaxed(bound_of(k)) <= make_key(0, index) && load_relaxed(&all->certain) != 0;
  }
  /// The same for what reaches to the surface from outside, whose distance is not below 0 either.
  CLEARANCE_HD bool touched(std::uint32_t index, std::uint32_t k) const {
    return load_relaxed(bound_of(k)) <= make_key(0, index);
  }
  CLEARANCE_HD bool ended(std::uint32_t) const { return false; }
  CLEARANCE_HD bool foresees(std::uint32_t, std::uint32_t, vec3, bool, const shared_nearest&) const { return false; }
  /// With an interior, once the bound is 0, lower point numbers matter before distances.
  CLEARANCE_HD bool lowest_first(std::uint32_t k) const { return reach(k) <= 0; }
  /// Returns true if it is still unknown whether some point is certainly inside.
  CLEARANCE_HD bool take_inside(std::uint32_t index, std::uint32_t k) const {
    lower_key(k, make_key(0, index));
    return load_relaxed(&all->certain) == 0;
  }
  CLEARANCE_HD void take_certain() const { add_to(&all->certain, 1); }

  CLEARANCE_HD shared_nearest visitor(std::uint32_t, std::uint32_t k) const { return {bound_of(k), extra_of(k)}; }
  CLEARANCE_HD void take(std::uint32_t index, std::uint32_t k, const shared_nearest& found) const {
    if (found.best < infinity) lower(index, k, found.best);
  }

 private:
  CLEARANCE_HD void lower_key(std::uint32_t k, distance_key key) const {
    distance_key* const bound = bound_of(k);
    if (key < load_relaxed(bound)) lower_to(bound, key);
    if (extra != nullptr && key < load_relaxed(part_best + k)) lower_to(part_best + k, key);
  }
};

}  // namespace clearance::minimum
