// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The scene's robot multiplied: many parts, robots far apart, very many spheres in one part. As many points as the
// frame.

#include "scene.hpp"

namespace bench {

inline Eigen::Isometry3d moved(const Eigen::Isometry3d& pose, const Eigen::Vector3d& by) {
  return Eigen::Translation3d(by) * pose;
}

/// Copies of the robot in a row behind it, 64 parts in all.
inline scene sixty_four_parts(const scene& one) {
  scene s;
  s.cloud = one.cloud, s.world_from_camera = one.world_from_camera;
  for (std::size_t k = 0; k < 64; ++k) {
    const std::size_t part = k % one.poses.size();
    s.packings.push_back(one.packings[part]);
    s.poses.push_back(moved(one.poses[part], {-0.8 * double(k / one.poses.size()), 0, 0}));
  }
  return s;
}

/// A second robot 20 m away; every other point of the frame moves there.
inline scene two_robots(const scene& one) {
  scene s = one;
  const Eigen::Vector3d by(20, 0, 0), in_camera = one.world_from_camera.linear().transpose() * by;
  for (std::size_t k = 0; k < one.poses.size(); ++k) {
    s.packings.push_back(one.packings[k]);
    s.poses.push_back(moved(one.poses[k], by));
  }
  const clearance::vec3 shift{float(in_camera.x()), float(in_camera.y()), float(in_camera.z())};
  for (std::size_t i = 1; i < s.cloud.size(); i += 2) s.cloud[i] = s.cloud[i] + shift;
  return s;
}

/// The whole robot as one rigid part of 100,000 spheres: each link's, and smaller ones inside them.
inline scene one_large_part(const scene& one) {
  scene s;
  s.cloud = one.cloud, s.world_from_camera = one.world_from_camera;
  s.poses = {one.poses[0]};
  s.packings.emplace_back();
  auto& spheres = s.packings[0].spheres;
  std::mt19937 bits(3);
  std::uniform_real_distribution<float> within(-0.25f, 0.25f);  // of the radius; with the new radius it stays inside
  for (bool first = true; spheres.size() < 100000; first = false)
    for (std::size_t k = 0; k < one.poses.size(); ++k) {
      const Eigen::Isometry3f to = (one.poses[0].inverse() * one.poses[k]).cast<float>();
      for (auto b : one.packings[k].spheres) {
        if (spheres.size() == 100000) break;
        const Eigen::Vector3f c = to * Eigen::Vector3f(b.center.x, b.center.y, b.center.z);
        b.center = {c.x(), c.y(), c.z()};
        if (!first)
          b = {b.center + clearance::scaled(b.radius, {within(bits), within(bits), within(bits)}), b.radius / 2};
        spheres.push_back(b);
      }
    }
  return s;
}

}  // namespace bench
