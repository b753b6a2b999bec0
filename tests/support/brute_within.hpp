// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points within a distance by definition, and how a result differs from it.

#include "support/brute_distances.hpp"

#include <clearance/questions/within.hpp>

namespace testing {

template <class P>
clearance::within_result brute_within(const scene<P>& s, const clouds& all, const std::vector<real>& radius) {
  clearance::within_result r;
  r.offsets.assign(s.parts.size() + 1, 0);
  for_each_pair(s, all, [&](const clearance::pair_distance& pair) {
    if (!(pair.distance <= radius[pair.part])) return;
    r.pairs.push_back(pair);
    for (std::size_t k = pair.part + 1; k < r.offsets.size(); ++k) ++r.offsets[k];
  });
  std::ranges::stable_sort(r.pairs, {},
                           [](const clearance::pair_distance& p) { return std::pair(p.part, p.distance); });
  return r;
}

inline void require_same(const clearance::within_result& found, const clearance::within_result& expected, verdict& v,
                         const std::string& what) {
  v.require(found.offsets == expected.offsets, what, ": ", found.pairs.size(), " pairs and not ",
            expected.pairs.size());
  const bool same = std::ranges::equal(found.pairs, expected.pairs,
                                       [](const clearance::pair_distance& a, const clearance::pair_distance& b) {
                                         return a.cloud == b.cloud && a.point == b.point && a.part == b.part &&
                                                a.primitive == b.primitive && same_bits(a.distance, b.distance);
                                       });
  v.require(same, what, ": some pair differs");
}

/// The same for a list in any order that claims `count` pairs.
inline void require_listed(std::vector<clearance::pair_distance> pairs, unsigned long long count,
                           clearance::within_result expected, verdict& v, const std::string& what) {
  v.require(count == expected.pairs.size() && pairs.size() == count, what, ": ", count, " pairs and not ",
            expected.pairs.size());
  for (auto* list : {&pairs, &expected.pairs})
    std::ranges::sort(*list, {},
                      [](const clearance::pair_distance& p) { return std::tuple(p.part, p.cloud, p.point); });
  clearance::within_result found = expected;
  found.pairs = std::move(pairs);
  require_same(found, expected, v, what);
}

/// Two balls among 50,000 points: more pairs than a list has room for at first.
inline scene<inner_sphere> two_balls() {
  dice d(99);
  scene<inner_sphere> s;
  for (int part = 0; part < 2; ++part)
    s.parts.push_back({{{0.1f * float(part), 0, 0}, 0.1f}}), s.poses.push_back(Eigen::Isometry3d::Identity());
  s.points = d.points(50000, 1);
  return s;
}

}  // namespace testing
