// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points within a distance by the definition, and what differs from it.

#include "support/brute_distances.hpp"

#include <clearance/within.hpp>

namespace testing {

template <class P>
clearance::within_result brute_within(const scene<P>& s, const std::vector<clearance::placed<clearance::point_span>>& clouds,
                                      const std::vector<real>& radius) {
  clearance::within_result all;
  all.offsets.push_back(0);
  for (std::uint32_t k = 0; k < s.parts.size(); ++k) {
    std::vector<clearance::pair_distance> its;
    for (std::uint32_t c = 0; c < clouds.size(); ++c) {
      std::vector<clearance::part_facts> facts;
      for (const auto& primitives : s.parts) {
        const ball around = clearance::enclosing_ball(std::span<const P>(primitives));
        facts.push_back({around.center, around.radius, 0, 0});
      }
      const clearance::frames::cloud_frame frame(facts, s.poses, clouds[c].pose);
      for (std::uint32_t i = 0; i < clouds[c].source.size(); ++i) {
        const clearance::sample point = clouds[c].source[i];
        if (!point.valid()) continue;
        const vec3 q = frame.places[k].part_from_cloud(point.position - frame.origin);
        clearance::pair_distance pair{c, i, k, ~0u, clearance::infinity};
        for (std::uint32_t n = 0; n < s.parts[k].size(); ++n)
          if (const real d = s.parts[k][n].distance(q); d < pair.distance) pair.distance = d, pair.primitive = n;
        if (pair.distance <= radius[k]) its.push_back(pair);
      }
    }
    std::ranges::stable_sort(its, {}, &clearance::pair_distance::distance);
    all.pairs.insert(all.pairs.end(), its.begin(), its.end());
    all.offsets.push_back(all.pairs.size());
  }
  return all;
}

inline void require_same(const clearance::within_result& found, const clearance::within_result& expected, verdict& v, const std::string& what) {
  v.require(found.offsets == expected.offsets, what, ": ", found.pairs.size(), " pairs and not ", expected.pairs.size());
  const bool same = std::ranges::equal(found.pairs, expected.pairs, [](const clearance::pair_distance& a, const clearance::pair_distance& b) {
    return a.cloud == b.cloud && a.point == b.point && a.part == b.part && a.primitive == b.primitive && same_bits(a.distance, b.distance);
  });
  v.require(same, what, ": some pair differs");
}

}  // namespace testing
