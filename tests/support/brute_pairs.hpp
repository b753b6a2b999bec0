// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every pair of a point and a part by definition: all points with all primitives.

#include "support/scenes.hpp"

#include <clearance/frames/clouds.hpp>

namespace testing {

using clouds = std::vector<clearance::placed<clearance::point_span>>;

inline const auto nothing_inside = [](std::uint32_t, vec3) { return false; };

template <class P>
std::vector<clearance::part_facts> facts_of(const scene<P>& s) {
  std::vector<clearance::part_facts> facts;
  for (const auto& primitives : s.parts) {
    const ball around = clearance::enclosing_ball(std::span<const P>(primitives));
    facts.push_back({around.center, around.radius, 0, 0});
  }
  return facts;
}

/// Calls `f` with the pairs of a source's valid points and all parts, in order. `inside(k, q)`: is q in part k's solid?
template <class P, class Source, class Inside, class F>
void for_each_pair(const scene<P>& s, const Source& source, const Eigen::Isometry3d& pose, std::uint32_t cloud,
                   Inside inside, F f) {
  const clearance::frames::cloud_frame frame(facts_of(s), s.poses, pose);
  for (std::uint32_t i = 0; i < source.size(); ++i) {
    const clearance::sample point = source[i];
    for (std::uint32_t k = 0; point.valid() && k < s.parts.size(); ++k) {
      const vec3 q = frame.places[k].part_from_cloud(point.position - frame.origin);
      clearance::pair_distance pair{cloud, i, k, ~0u, clearance::infinity};
      if (inside(k, q)) {
        pair.distance = 0;
      } else {
        for (std::uint32_t n = 0; n < s.parts[k].size(); ++n)
          if (const real d = s.parts[k][n].distance(q); d < pair.distance) pair.distance = d, pair.primitive = n;
      }
      f(pair);
    }
  }
}
template <class P, class F>
void for_each_pair(const scene<P>& s, const clouds& all, F f) {
  for (std::uint32_t c = 0; c < all.size(); ++c) for_each_pair(s, all[c].source, all[c].pose, c, nothing_inside, f);
}

/// The possible error of a distance, over all clouds.
template <class P>
clearance::frames::float_error error_of(const scene<P>& s, const clouds& all) {
  clearance::frames::float_error error;
  for (const auto& cloud : all) error.widen(clearance::frames::cloud_frame(facts_of(s), s.poses, cloud.pose).error);
  return error;
}

/// A scene's cloud, and half of it in another place.
template <class P>
clouds two_clouds(const scene<P>& s) {
  using clearance::point_span;
  return {{point_span(s.points), s.cloud_pose},
          {point_span(s.points.data(), s.points.size() / 2), shifted(0.1, 0, 0) * s.cloud_pose}};
}

/// Three parts of small spheres among 300,000 points.
inline scene<inner_sphere> crowd(unsigned seed) {
  dice d(seed);
  scene<inner_sphere> s;
  for (int part = 0; part < 3; ++part) {
    s.parts.emplace_back();
    for (int k = 0; k < 100; ++k) s.parts.back().push_back({d.point(0.2f), d.number(0.005, 0.02)});
    s.poses.push_back(d.pose(0.3));
  }
  s.points = d.points(300000, 0.6);
  return s;
}

}  // namespace testing
