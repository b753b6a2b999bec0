// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every part's distance to every point by definition, and how a result differs from it.

#include "support/brute_distances.hpp"

#include <clearance/questions/distances_per_part.hpp>

namespace testing {

/// `inside(k, q)`: is q in part k's solid?
template <class P, class Inside>
clearance::part_distances brute_per_part(const scene<P>& s, const clouds& all, real d_max, Inside inside) {
  clearance::part_distances r;
  std::vector<real> row;
  std::vector<std::size_t> first;
  for (const auto& cloud : all) {
    first.push_back(row.size());
    for (std::size_t i = 0; i < cloud.source.size(); ++i) {
      const clearance::sample point = cloud.source[i];
      row.push_back(point.valid() ? clearance::infinity : clearance::not_a_number);
      ++r.counts.seen, r.counts.valid += point.valid();
      if (!point.valid()) ++r.counts.dropped[int(point.dropped)];
    }
  }
  r.points = row.size(), r.parts = s.parts.size();
  for (std::size_t k = 0; k < s.parts.size(); ++k) r.distance.insert(r.distance.end(), row.begin(), row.end());
  for (std::uint32_t c = 0; c < all.size(); ++c)
    for_each_pair(s, all[c].source, all[c].pose, c, inside, [&](const clearance::pair_distance& pair) {
      if (pair.distance <= d_max) r.distance[pair.part * r.points + first[c] + pair.point] = pair.distance;
    });
  return r;
}

inline void require_same(const clearance::part_distances& found, const clearance::part_distances& expected, verdict& v,
                         const std::string& what) {
  const auto same = [](real a, real b) { return (a != a && b != b) || same_bits(a + 0.0f, b + 0.0f); };
  v.require(found.points == expected.points && found.parts == expected.parts &&
                std::ranges::equal(found.distance, expected.distance, same),
            what, ": some distance differs");
  v.require(same_counts(found.counts, expected.counts), what, ": other counts");
}

}  // namespace testing
