// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points in zones by the definition, and what differs from it.

#include "support/brute_distances.hpp"

#include <clearance/zones.hpp>

namespace testing {

/// All points of clouds against all primitives: those whose computed distance is at most the threshold and what is uncertain of it,
/// worked out in long double.
template <class P>
clearance::zones_result brute_zones(const scene<P>& s, const std::vector<clearance::placed<clearance::point_span>>& clouds,
                                    const std::vector<std::vector<double>>& thresholds) {
  clearance::zones_result all;
  all.per_part = thresholds[0].size();
  std::vector<clearance::part_facts> facts;
  for (const auto& primitives : s.parts) {
    const ball around = clearance::enclosing_ball(std::span<const P>(primitives));
    facts.push_back({around.center, around.radius, 0, 0});
  }
  clearance::frames::float_error error;
  for (const auto& cloud : clouds) error.widen(clearance::frames::cloud_frame(facts, s.poses, cloud.pose).error);
  for (std::size_t k = 0; k < s.parts.size(); ++k)
    for (const double threshold : thresholds[k]) {
      clearance::zone z;
      for (std::uint32_t c = 0; c < clouds.size(); ++c) {
        const clearance::frames::cloud_frame frame(facts, s.poses, clouds[c].pose);
        for (std::uint32_t i = 0; i < clouds[c].source.size(); ++i) {
          const clearance::sample point = clouds[c].source[i];
          if (!point.valid()) continue;
          const vec3 q = frame.places[k].part_from_cloud(point.position - frame.origin);
          real least = clearance::infinity;
          for (const P& primitive : s.parts[k]) least = std::min(least, primitive.distance(q));
          // It may be nearer by `here`, and by `per_metre` of what it is.
          const long double may_be = (long double)(least) - error.here - (long double)(error.per_metre) * std::abs(least);
          if (may_be > threshold) continue;
          ++z.points;
          if (z.first_point == ~0u) z.first_cloud = c, z.first_point = i;
          if (least < z.nearest) z.nearest = least, z.nearest_cloud = c, z.nearest_point = i;
        }
      }
      all.zones.push_back(z);
    }
  return all;
}

/// `found` may count what lies on the last digit of a threshold; `slack` says how many such points there were.
inline void require_same(const clearance::zones_result& found, const clearance::zones_result& expected, verdict& v, const std::string& what) {
  v.require(found.zones.size() == expected.zones.size() && found.per_part == expected.per_part, what, ": ", found.zones.size(), " zones");
  for (std::size_t i = 0; i < std::min(found.zones.size(), expected.zones.size()); ++i) {
    const clearance::zone &a = found.zones[i], &b = expected.zones[i];
    v.require(a.points == b.points && same_bits(a.nearest, b.nearest) && a.nearest_cloud == b.nearest_cloud && a.nearest_point == b.nearest_point &&
                  a.first_cloud == b.first_cloud && a.first_point == b.first_point,
              what, ", zone ", i, ": ", a.points, " points and not ", b.points, ", nearest ", a.nearest, " and not ", b.nearest, " at ", a.nearest_point, " and not ",
              b.nearest_point, ", first ", a.first_point, " and not ", b.first_point);
  }
}

}  // namespace testing
