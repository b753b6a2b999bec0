// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points are the robot's own by definition, and how a result differs from it.

#include "support/brute_distances.hpp"
#include "support/brute_pairs.hpp"

#include <clearance/questions/min_distance_filtered.hpp>

namespace testing {

/// Compares all points with all primitives; a distance's uncertainty is computed in long double.
template <class P>
clearance::self_filter_result brute_own(const scene<P>& s, const clouds& all, const std::vector<double>& padding) {
  using clearance::point_label;
  clearance::self_filter_result r;
  r.offsets = {0};
  for (const auto& cloud : all) {
    for (std::size_t i = 0; i < cloud.source.size(); ++i) {
      const bool valid = cloud.source[i].valid();
      r.labels.push_back(valid ? point_label::rest : point_label::no_point);
      r.counts.points.valid += valid;
    }
    r.offsets.push_back(r.labels.size());
  }
  r.counts.points.seen = r.labels.size();
  const auto error = error_of(s, all);
  for_each_pair(s, all, [&](const clearance::pair_distance& pair) {
    const long double d = pair.distance, off = error.here + (long double)(error.per_metre) * std::abs(d);
    point_label& label = r.labels[r.offsets[pair.cloud] + pair.point];
    if (d + off <= padding[pair.part])
      label = point_label::own;
    else if (d - off <= padding[pair.part] && label == point_label::rest)
      label = point_label::uncertain;
  });
  for (std::size_t i = 0; i < r.labels.size(); ++i) {
    r.counts.own += r.labels[i] == point_label::own, r.counts.uncertain += r.labels[i] == point_label::uncertain;
    if (r.labels[i] == point_label::rest || r.labels[i] == point_label::uncertain) r.rest.push_back(std::uint32_t(i));
  }
  return r;
}

inline void require_same(const clearance::self_filter_result& found, const clearance::self_filter_result& expected,
                         verdict& v, const std::string& what) {
  v.require(found.labels == expected.labels, what, ": some label differs");
  v.require(found.offsets == expected.offsets && found.rest == expected.rest, what, ": ", found.rest.size(),
            " points are left, and not ", expected.rest.size());
  v.require(found.counts.own == expected.counts.own && found.counts.uncertain == expected.counts.uncertain, what, ": ",
            found.counts.own, " own, ", found.counts.uncertain, " uncertain");
  v.require(found.counts.points.seen == expected.counts.points.seen &&
                found.counts.points.valid == expected.counts.points.valid,
            what, ": counts of points");
}

/// The clouds with every hidden point made invalid, in memory that `kept` holds.
inline clouds without(const clouds& all, const clearance::self_filter_result& hidden,
                      std::vector<std::vector<vec3>>& kept) {
  clouds rest;
  kept.assign(all.size(), {});
  for (std::size_t c = 0; c < all.size(); ++c) {
    const clearance::point_span span = all[c].source;
    kept[c].assign(span.points, span.points + span.size());
    for (std::size_t i = 0; i < kept[c].size(); ++i)
      if (hidden.labels[hidden.offsets[c] + i] == clearance::point_label::own) kept[c][i].x = clearance::not_a_number;
    rest.push_back({clearance::point_span(kept[c]), all[c].pose});
  }
  return rest;
}

/// Compares the rest: everything in a result but the reasons why points were dropped.
inline void require_rest(const clearance::filtered_distance& found, clearance::min_distance_result expected, verdict& v,
                         const std::string& what) {
  using clearance::drop_reason;
  const auto& r = found.rest;
  v.require(r.state == expected.state && same_bits(r.distance, expected.distance) &&
                same_bits(r.lower, expected.lower) && same_bits(r.upper, expected.upper) && r.cloud == expected.cloud &&
                r.point == expected.point && r.part == expected.part && r.primitive == expected.primitive,
            what, ": the minimum of the rest is ", r.distance, " at ", r.point, ", and not ", expected.distance, " at ",
            expected.point);
  v.require(r.seen == expected.seen && r.valid == expected.valid &&
                r.dropped[int(drop_reason::masked)] == found.filter.counts.own &&
                r.dropped[int(drop_reason::masked)] + r.dropped[int(drop_reason::not_finite)] ==
                    expected.dropped[int(drop_reason::not_finite)],
            what, ": ", r.dropped[int(drop_reason::masked)], " are masked of ", found.filter.counts.own);
}

}  // namespace testing
