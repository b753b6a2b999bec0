// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What is certain after a search that stopped at a distance.

#include <clearance/frame/bracket.hpp>

namespace clearance::minimum {

/// Completes a concluded result without a minimum: if there were points, none of them is within `d_max`.
CLEARANCE_HD inline void beyond(min_distance_result& r, real d_max, double slop, const frames::float_error& error) {
  if (r.part != none || r.valid == 0 || !(d_max < infinity)) return;
  const double lower = certain_distance(d_max, slop, error);
  r.distance = infinity;
  r.lower = lower > 0 ? rounded_down(lower) : 0;
  r.state = r.lower > 0 ? state::free : state::possible;
  allow_for_too_close(r);
}
/// Changes a whole result as if its search had stopped at `d_max`.
CLEARANCE_HD inline void cut(min_distance_result& r, real d_max, double slop, const frames::float_error& error) {
  if (r.part == none || r.distance <= d_max) return;
  min_distance_result none_within;
  none_within.seen = r.seen, none_within.valid = r.valid;
  for (int k = 0; k < drop_reasons; ++k) none_within.dropped[k] = r.dropped[k];
  r = none_within;
  beyond(r, d_max, slop, error);
}

}  // namespace clearance::minimum
