// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From minima to what is certain.

#include <clearance/frame/frame.hpp>
#include <clearance/result.hpp>

namespace clearance::minimum {

/// The solid is certainly at least this far away (metres): `distance` less `slop` (gap and tolerance) and errors.
CLEARANCE_HD inline double certain_distance(real distance, double slop, const frames::float_error& error) {
  return double(distance) - slop - error.at(distance);
}

/// The same over all parts' minima: `distance(k)` and `facts(k)` are those of part k.
template <class Distance, class Facts>
CLEARANCE_HD double certain_distance(std::uint32_t parts, Distance distance, Facts facts,
                                     const frames::float_error& error) {
  double least = infinity;
  for (std::uint32_t k = 0; k < parts; ++k) {
    const double its = certain_distance(distance(k), frames::slop(facts(k)), error);
    least = its < least ? its : least;
  }
  return least;
}

/// Adds bracket and state to a result that has distance and part. The distance is at least `lower`, and the winning
/// part may differ by `tolerance` from its surface. `certain`: some point is certainly inside.
CLEARANCE_HD inline void bracket(min_distance_result& r, double lower, real tolerance, bool certain,
                                 const frames::float_error& error) {
  if (r.part == none) return;  // no data
  const double error_here = error.at(r.distance);
  const bool inside = certain || r.distance < -(error_here + tolerance);
  // With a point inside, the distance is 0. Without a certificate (an infinite gap) `lower` is 0.
  r.lower = lower > 0 && !inside ? rounded_down(lower) : 0;
  const double most = double(r.distance) + tolerance + error_here;  // below 0 only if it is certainly inside
  r.upper = inside || most < 0 ? 0 : rounded_up(most);
  r.state = inside ? clearance::state::collision : (r.lower > 0 ? clearance::state::free : clearance::state::possible);
}

/// Something nearer than a sensor can measure may be anywhere in front of it, so nothing is free then. Call it after
/// counts and bracket.
CLEARANCE_HD inline void allow_for_too_close(min_distance_result& r) {
  if (r.dropped[int(drop_reason::too_close)] != 0 && r.state == clearance::state::free)
    r.state = clearance::state::possible, r.lower = 0;
}

}  // namespace clearance::minimum

namespace clearance {

/// How certain a computed distance is: the error of arithmetic, poses and the source's own rounding, and by how much a
/// part may be nearer than its primitives (gap and tolerance). Metres.
struct distance_certainty {
  frames::float_error error;
  double slop = 0;

  /// The solid is at least this far away; 0 if nothing more is certain, or if the distance is infinite or NaN.
  CLEARANCE_HD real lower(real distance) const {
    const double least = minimum::certain_distance(distance, slop, error);
    return least > 0 ? rounded_down(least) : 0;
  }
  /// Covers the other's distances, too.
  void widen(const distance_certainty& other) {
    error.widen(other.error);
    slop = other.slop > slop ? other.slop : slop;
  }
};

inline distance_certainty certainty_of(const frames::frame_facts& frame) { return {frame.error, frame.slop}; }

}  // namespace clearance
