// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/result.hpp>
#include <clearance/search/frame.hpp>

namespace clearance::search {

/// From the minimum to what is certain: counts, bracket, state. One thread, after the last cloud.
template <class PartView>
struct conclude_body {
  const PartView* parts;
  std::uint32_t part_count;
  const totals* all;
  const distance_key* part_best;
  double error;  ///< The largest `placement::error` of the call.
  std::uint64_t seen;
  min_distance_result* result;

  CLEARANCE_HD void operator()(std::size_t) const {
    min_distance_result& r = *result;
    r.seen = r.valid = seen;
    for (int k = 1; k < drop_reasons; ++k) {
      r.dropped[k] = all->dropped[k];
      r.valid -= all->dropped[k];
    }
    if (r.part == none) {
      // Valid points, yet none near enough to compare (coordinates overflow): as good as no data.
      r.state = state::no_data;
      return;
    }
    double lower = infinity;
    for (std::uint32_t k = 0; k < part_count; ++k) {
      // Without minima of its own, a part is only known to be no nearer than the nearest one.
      const real distance = part_best != nullptr ? key_distance(part_best[k]) : r.distance;
      const double certain = double(distance) - parts[k].facts.gap - parts[k].facts.tolerance - error_at(distance);
      lower = certain < lower ? certain : lower;
    }
    const part_facts& winner = parts[r.part].facts;
    const double error_here = error_at(r.distance);
    const double upper = r.distance < 0 ? 0 : double(r.distance) + winner.tolerance + error_here;
    // A negative distance, or a point inside, leaves nothing above 0; no certificate leaves nothing below.
    r.lower = lower > 0 ? rounded_down(lower) : 0;
    r.upper = rounded_up(upper);
    const bool inside = all->certain != 0 || r.distance < -(error_here + winner.tolerance);
    r.state = inside ? state::collision : (r.lower > 0 ? state::free : state::possible);
    if (all->certain != 0) r.upper = 0;
  }

 private:
  CLEARANCE_HD double error_at(real distance) const { return fma(unit_error, double(absolute(distance)), error); }
};

}  // namespace clearance::search
