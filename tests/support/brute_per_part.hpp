// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every part's distance to every point by definition, how a result differs from it, and what the laws ask.

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

/// For the laws of all questions.
struct per_part_cases {
  using question = clearance::distances_per_part;
  std::size_t near = 0, far = 0;

  template <class P>
  static std::vector<question> of_scene(const scene<P>& s) {
    return {{0}, {real(0.2 * s.size)}, {clearance::infinity}};
  }
  template <class P>
  static clearance::part_distances by_definition(const scene<P>& s, const clouds& all, const question& q) {
    return brute_per_part(s, all, real(q.d_max), nothing_inside);
  }
  static question of_frame(std::size_t number, std::size_t) { return {number % 2 == 0 ? 0.3f : clearance::infinity}; }
  static std::vector<question> refused() { return {{clearance::not_a_number}}; }
  void saw(const clearance::part_distances& r) {
    for (const real distance : r.distance)
      near += distance < clearance::infinity, far += distance == clearance::infinity;
  }

  static constexpr auto values = &clearance::part_distances::distance;
  static std::vector<real> room(std::size_t parts, std::size_t points) { return std::vector(parts * points, real(-1)); }
};

}  // namespace testing
