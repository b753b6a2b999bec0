// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Spheres in oriented boxes: an arm of two links, the distance of each, and the nearest of all.

#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/obb.hpp>

#include <cstdio>

template <clearance::backend Backend>
int example(const Backend& on) {
  // A link is a row of spheres, slanted in its own frame: what oriented boxes are good at.
  std::vector<clearance::inner_sphere> row;
  for (int k = 0; k < 100; ++k) row.push_back({{0.003f * k, 0.004f * k, 0}, 0.05f});
  const auto link = clearance::make_part(clearance::build<clearance::obb>(row));
  const auto arm = clearance::model(std::vector{link, link}).on(on);

  std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());  // world from part, one a part
  poses[1].translate(Eigen::Vector3d(0.3, 0.4, 0)).rotate(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()));
  std::vector<clearance::vec3> cloud;
  for (int k = 0; k < 1000; ++k) cloud.push_back({-1 + 0.002f * k, 1, 0.0005f * k});

  const auto [r, parts] = clearance::ask(on, arm, poses, cloud, clearance::min_distance_per_part{});
  for (const auto& minimum : parts) std::printf("%.6f m to point %u\n", minimum.distance, minimum.point);
  std::printf("certainly between %.6f m and %.6f m; nearest is part %u\n", r.lower, r.upper, r.part);

  // The same in a plain loop.
  for (std::size_t k = 0; k < 2; ++k) {
    double least = clearance::infinity;
    for (const auto& p : cloud)
      for (const auto& s : row) {
        const Eigen::Vector3d center = poses[k] * Eigen::Vector3d(s.center.x, s.center.y, s.center.z);
        least = std::min(least, (Eigen::Vector3d(p.x, p.y, p.z) - center).norm() - s.radius);
      }
    if (std::abs(parts[k].distance - least) > 2e-6) return 1;
  }
  return r.part == 1 && r.distance == parts[1].distance && r.lower <= r.distance && r.distance <= r.upper ? 0 : 1;
}
