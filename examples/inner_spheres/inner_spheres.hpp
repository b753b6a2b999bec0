// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Inner spheres in bounding spheres: a signed distance, and what it certifies about the solid.

#include <clearance/bvh/build.hpp>
#include <clearance/min_distance.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

template <clearance::backend Backend>
int example(const Backend& on) {
  // A rod of 2 cm by 2 cm by 40 cm, filled with the 20 largest spheres that fit side by side. Its corners are farthest
  // from them: no point of the rod is more than 7.4 mm away.
  std::vector<clearance::inner_sphere> spheres;
  for (int k = 0; k < 20; ++k) spheres.push_back({{0, 0, 0.01f + 0.02f * k}, 0.01f});
  auto rod = clearance::make_part(clearance::build<clearance::sphere>(spheres));
  rod.facts.gap = 0.0074f;
  const auto part = rod.on(on);
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();

  // A point 20 mm beside an edge of the rod, then one inside.
  std::vector<clearance::vec3> cloud = {{0.01f, 0.03f, 0.2f}, {5, 5, 5}};
  const auto outside = clearance::min_distance(on, part, pose, cloud);
  cloud.push_back({0, 0, 0.212f});
  const auto inside = clearance::min_distance(on, part, pose, cloud);
  for (const auto& r : {outside, inside})
    std::printf("%-9s %9.6f m to the spheres; the rod is certainly %.6f m to %.6f m away\n", clearance::to_string(r.state),
                r.distance, r.lower, r.upper);

  const bool bracketed = outside.lower < 0.02f && 0.02f < outside.upper && outside.state == clearance::state::free;
  return bracketed && inside.distance < 0 && inside.upper == 0 && inside.state == clearance::state::collision ? 0 : 1;
}
