// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points in zones by definition, and how a result differs from it, and what the laws ask.

#include "support/brute_distances.hpp"

#include <clearance/questions/zones.hpp>

namespace testing {

/// Compares all points of clouds with all primitives. A point counts if its computed distance is at most the threshold
/// plus the distance's uncertainty, which is computed in long double.
template <class P>
clearance::zones_result brute_zones(const scene<P>& s, const clouds& all,
                                    const std::vector<std::vector<double>>& thresholds) {
  clearance::zones_result r;
  r.per_part = thresholds[0].size();
  r.zones.resize(s.parts.size() * r.per_part);
  const auto error = error_of(s, all);
  for_each_pair(s, all, [&](const clearance::pair_distance& pair) {
    const long double may_be =
        (long double)(pair.distance) - error.here - (long double)(error.per_metre) * std::abs(pair.distance);
    for (std::size_t z = 0; z < r.per_part; ++z) {
      if (may_be > thresholds[pair.part][z]) continue;
      clearance::zone& its = r.zones[pair.part * r.per_part + z];
      if (its.points++ == 0) its.first_cloud = pair.cloud, its.first_point = pair.point;
      if (pair.distance < its.nearest)
        its.nearest = pair.distance, its.nearest_cloud = pair.cloud, its.nearest_point = pair.point;
    }
  });
  return r;
}

inline void require_same(const clearance::zones_result& found, const clearance::zones_result& expected, verdict& v,
                         const std::string& what) {
  v.require(found.zones.size() == expected.zones.size() && found.per_part == expected.per_part, what, ": ",
            found.zones.size(), " zones");
  for (std::size_t i = 0; i < std::min(found.zones.size(), expected.zones.size()); ++i) {
    const clearance::zone &a = found.zones[i], &b = expected.zones[i];
    v.require(a.points == b.points && same_bits(a.nearest, b.nearest) && a.nearest_cloud == b.nearest_cloud &&
                  a.nearest_point == b.nearest_point && a.first_cloud == b.first_cloud &&
                  a.first_point == b.first_point,
              what, ", zone ", i, ": ", a.points, " points and not ", b.points, ", nearest ", a.nearest, " and not ",
              b.nearest, " at ", a.nearest_point, " and not ", b.nearest_point, ", first ", a.first_point, " and not ",
              b.first_point);
  }
}

/// For the laws of all questions.
struct zones_cases {
  using question = clearance::zones;
  std::size_t counted = 0;

  template <class P>
  static std::vector<question> of_scene(const scene<P>& s) {
    question all{.thresholds = {0, 0.05 * s.size, 0.5 * s.size}}, of_each{.thresholds = {}, .each_part = true};
    for (std::size_t k = 1; k <= s.parts.size(); ++k)
      for (const double share : {0.1, 0.3}) of_each.thresholds.push_back(share * double(k) * s.size);
    return {all, of_each};
  }
  template <class P>
  static clearance::zones_result by_definition(const scene<P>& s, const clouds& all, const question& q) {
    std::vector<std::vector<double>> own;
    const auto n = std::ptrdiff_t(q.per_part(s.parts.size()));
    for (std::size_t k = 0; k < s.parts.size(); ++k) {
      const auto its = q.thresholds.begin() + (q.each_part ? std::ptrdiff_t(k) * n : 0);
      own.emplace_back(its, its + n);
    }
    return brute_zones(s, all, own);
  }
  static question of_frame(std::size_t number, std::size_t) {
    return {.thresholds = number % 2 == 1 ? std::vector{0.02, 0.3} : std::vector{0.0, 0.05, 0.4}};
  }
  static std::vector<question> refused() { return {{.thresholds = {0.2, 0.1}}}; }
  void saw(const clearance::zones_result& r) {
    for (const auto& zone : r.zones) counted += zone.points;
  }

  static constexpr auto values = &clearance::zones_result::zones;
  static std::vector<clearance::zone> room(std::size_t parts, std::size_t) {
    return std::vector(3 * parts, clearance::zone{.points = 77});
  }
};

}  // namespace testing
