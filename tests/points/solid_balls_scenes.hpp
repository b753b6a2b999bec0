// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A scene's points as full balls, and what a plain loop in long double says about the solids that they fill.

#include "support/oracle.hpp"
#include "support/scenes.hpp"

#include <clearance/frames/clouds.hpp>
#include <clearance/points/solid_balls.hpp>

namespace testing {

using clearance::infinity;
using oracle::wide, oracle::wider;

/// A radius for each of `n` balls: some are 0, and a few are large.
inline std::vector<real> ball_radii_of(dice& d, std::size_t n, double size) {
  std::vector<real> radii;
  for (std::size_t i = 0; i < n; ++i) {
    const unsigned kind = d.below(8);
    radii.push_back(kind == 0 ? 0 : d.number(0, kind == 1 ? size : 0.05 * size));
  }
  return radii;
}

template <class P>
wide distance_to(oracle::vec q, const P& primitive) {
  if constexpr (std::is_same_v<P, inner_sphere>)
    return oracle::to_sphere(q, wider(primitive.center), primitive.radius);
  else
    return oracle::to_triangle(q, wider(primitive.a), wider(primitive.b), wider(primitive.c));
}

/// How far the parts are from solids that these balls fill, at least 0: all balls, and a few places within the gap of
/// each.
template <class P, class S>
wide true_distance(const scene<P>& s, const std::vector<clearance::placed<S>>& all, dice& d) {
  wide least = infinity;
  for (const auto& cloud : all)
    for (std::size_t i = 0; i < cloud.source.size(); ++i) {
      const clearance::sample center = cloud.source[i];
      if (!center.valid()) continue;
      const wide radius = cloud.source.radius(i), gap = cloud.source.gap;
      for (int place = 0; place < (i % 4 == 0 ? 3 : 1); ++place) {
        const wide by = place == 0 ? 0 : radius + gap * wide(d.uniform(0, 1));
        const auto world = oracle::moved(cloud.pose.matrix(), wider(center.position) + by * wider(d.direction()));
        for (std::size_t k = 0; k < s.parts.size(); ++k) {
          const auto q = oracle::moved_back(s.poses[k].matrix(), world);
          for (const P& primitive : s.parts[k])
            least = std::min(least, distance_to(q, primitive) - (place == 0 ? radius : 0));
        }
      }
    }
  return std::max(least, wide(0));
}

}  // namespace testing
