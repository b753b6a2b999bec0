// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Scenes whose points and parts have radii, and what a plain loop over all pairs says about them.

#include "support/brute_pairs.hpp"
#include "support/oracle.hpp"
#include "support/product.hpp"
#include "support/same_answer.hpp"
#include "support/same_result.hpp"

#include <clearance/questions/certain_distance.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/zones.hpp>

namespace testing {

using clearance::certain_distance, clearance::cloud_uncertainty;

/// A scene's points with a radius each, some of them 0, and its parts with radii.
template <class P>
struct uncertain_scene {
  scene<P> s;
  std::vector<real> radii;
  std::vector<clearance::part_radius> parts;
  cloud_uncertainty all;

  uncertain_scene(const scene<P>& of, unsigned seed, double scale) : s(of) {
    dice d(seed);
    for (std::size_t i = 0; i < s.points.size(); ++i)
      radii.push_back(d.below(4) == 0 ? 0 : d.number(0, scale * s.size));
    for (std::size_t k = 0; k < s.parts.size(); ++k) {
      const double joints = d.uniform(0, 0.3 * scale * s.size), delay = d.uniform(0, 0.3 * scale * s.size);
      parts.push_back({joints, delay});
    }
    all = {0.01 * scale * s.size, 1e-3 * scale, 0.1 * scale * s.size, 0.2};
  }

  std::vector<double> radii_of_parts() const { return clearance::sums(parts); }
  auto source(const real* at, const clearance::vec3* points) const {
    return clearance::uncertain(clearance::point_span(points, s.points.size()),
                                clearance::point_radii(at, radii.size()), all);
  }
  auto source() const { return source(radii.data(), s.points.data()); }
};

/// The least of (distance - radius) for every part, and the point.
template <class P, class S>
std::vector<clearance::part_minimum> least_certain(const scene<P>& s, const std::vector<clearance::placed<S>>& all) {
  std::vector<clearance::part_minimum> least(s.parts.size());
  for (std::uint32_t c = 0; c < all.size(); ++c)
    for_each_pair(s, all[c].source, all[c].pose, c, nothing_inside, [&](const clearance::pair_distance& pair) {
      const S& source = all[c].source;
      const real d = pair.distance - source.around(pair.point, source[pair.point].position).radius;
      if (d < least[pair.part].distance) least[pair.part] = {d, c, pair.point, pair.primitive};
    });
  return least;
}

/// A place within `radius` of p.
inline oracle::vec moved_within(dice& d, oracle::vec p, wide radius) {
  return p + (radius * wide(d.uniform(0, 1))) * wider(d.direction());
}

/// The distances of all parts in long double, at least 0, with every point and every part somewhere within its radius.
template <class P, class S>
std::vector<wide> truths(const scene<P>& s, const std::vector<clearance::placed<S>>& all,
                         const std::vector<double>& radii, dice& d) {
  std::vector<oracle::vec> by;
  for (const double r : radii) by.push_back(moved_within(d, {0, 0, 0}, r));
  std::vector<wide> least(s.parts.size(), clearance::infinity);
  for (const auto& cloud : all)
    for (std::size_t i = 0; i < cloud.source.size(); ++i) {
      const clearance::sample p = cloud.source[i];
      if (!p.valid()) continue;
      auto at = wider(p.position);
      if constexpr (clearance::vague_source<S>)
        at = moved_within(d, at, cloud.source.shares(i, p.position).sum() / cloud.source.spread);
      const auto world = oracle::moved(cloud.pose.matrix(), at);
      for (std::size_t k = 0; k < s.parts.size(); ++k) {
        const auto q = oracle::moved_back(s.poses[k].matrix(), world - by[k]);
        for (const P& primitive : s.parts[k])
          if constexpr (std::is_same_v<P, inner_sphere>)
            least[k] = std::min(least[k], oracle::to_sphere(q, wider(primitive.center), primitive.radius));
          else
            least[k] =
                std::min(least[k], oracle::to_triangle(q, wider(primitive.a), wider(primitive.b), wider(primitive.c)));
      }
    }
  for (wide& its : least) its = std::max(its, wide(0));
  return least;
}

}  // namespace testing
