// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/result.hpp>
#include <clearance/search/frame.hpp>

namespace clearance::search {

/// How many points there were, and how many of them count.
CLEARANCE_HD inline void count(min_distance_result& r, const totals& all, std::uint64_t seen) {
  r.seen = r.valid = seen;
  for (int k = 1; k < drop_reasons; ++k) {
    r.dropped[k] = all.dropped[k];
    r.valid -= all.dropped[k];
  }
}

/// From the minimum to what is certain; `certain`: some point is certainly inside.
CLEARANCE_HD inline void bracket(min_distance_result& r, double lower, real winner_tolerance, bool certain, const float_error& error) {
  if (r.part == none) return;  // no data
  const double error_here = error.at(r.distance);
  const bool inside = certain || r.distance < -(error_here + winner_tolerance);
  // A point inside leaves nothing above 0, and a missing certificate (an infinite gap) nothing below.
  r.lower = lower > 0 && !inside ? rounded_down(lower) : 0;
  const double most = double(r.distance) + winner_tolerance + error_here;  // below 0 only if it is certainly inside
  r.upper = inside || most < 0 ? 0 : rounded_up(most);
  r.state = inside ? state::collision : (r.lower > 0 ? state::free : state::possible);
}

/// What a minimum of `distance` leaves certain for a part that may be nearer by `slop` (gap and tolerance).
CLEARANCE_HD inline double certain_distance(real distance, double slop, const float_error& error) {
  return double(distance) - slop - error.at(distance);
}
CLEARANCE_HD inline double slop(const part_facts& f) { return double(f.gap) + double(f.tolerance); }

/// One thread, after the last cloud.
template <class PartView>
struct conclude_body {
  const PartView* parts;
  std::uint32_t part_count;
  const totals* all;
  const distance_key* part_best;
  float_error error;    ///< The largest of the call.
  double largest_slop;  ///< Of all parts: all that is known of a part without a minimum of its own.
  std::uint64_t seen;
  min_distance_result* result;

  CLEARANCE_HD void operator()(std::size_t) const {
    const real d = result->distance;
    double lower = certain_distance(d, largest_slop, error);
    if (part_best != nullptr) {
      lower = infinity;
      for (std::uint32_t k = 0; k < part_count; ++k) {
        const double its = certain_distance(key_distance(part_best[k]), slop(parts[k].facts), error);
        lower = its < lower ? its : lower;
      }
    }
    count(*result, *all, seen);
    bracket(*result, lower, result->part == none ? 0 : parts[result->part].facts.tolerance, all->certain != 0, error);
  }
};

}  // namespace clearance::search
