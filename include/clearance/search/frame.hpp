// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What one search shares between its points: the bound, the counts, and where the parts are in this cloud's frame.

#include <clearance/ordered.hpp>
#include <clearance/part.hpp>
#include <clearance/pose.hpp>

namespace clearance::search {

/// Shared by all points of all clouds of a call.
struct totals {
  distance_key best = no_key;
  unsigned long long dropped[drop_reasons] = {};
  unsigned long long certain = 0;  ///< Not 0: some point is inside a part by more than rounding.
};

/// A part as seen from a cloud.
struct placement {
  rigid_transform part_from_cloud;  ///< The exact path: one fixed sequence of operations.
  ball around;                      ///< The part's ball in the cloud's frame, its radius enlarged by every error.
  real error;                       ///< Most that float arithmetic can be off near this part, at distance 0.
  world_transform world_from_part;
};

/// A float result at `distance` is off by at most error + unit_error * |distance|: 16 units of rounding of
/// |p| + |t| + part size. Transform, deprojection and leaf formulas together stay below ten.
inline constexpr double unit_error = 0x1p-20;

/// Where the cloud's coordinates start to be subtracted: near the robot, in steps of 64 m, so that ordinary scenes lose
/// nothing and clouds in world coordinates of 1e6 m no more than their own coordinates have lost.
inline vec3 origin_near(const Eigen::Vector3d& robot_in_cloud) {
  const auto step = [](double x) { return real(std::round(x / 64) * 64); };
  return {step(robot_in_cloud.x()), step(robot_in_cloud.y()), step(robot_in_cloud.z())};
}

/// `part_from_cloud` maps positions that `origin` was subtracted from.
inline placement place(const part_facts& facts, const Eigen::Isometry3d& world_from_part, const Eigen::Isometry3d& world_from_cloud,
                       vec3 origin) {
  Eigen::Isometry3d part_from_cloud = world_from_part.inverse() * world_from_cloud;
  part_from_cloud.translation() = world_from_part.inverse() * (world_from_cloud * Eigen::Vector3d(origin.x, origin.y, origin.z));
  const Eigen::Vector3d part_center(facts.center.x, facts.center.y, facts.center.z);
  const Eigen::Vector3d center = part_from_cloud.inverse() * part_center;
  const double size = part_center.norm() + facts.radius, away = part_from_cloud.translation().norm();
  const double error = unit_error * 2 * (size + away);
  placement p;
  p.part_from_cloud = to_floats(part_from_cloud);
  p.around = {{real(center.x()), real(center.y()), real(center.z())}, rounded_up(facts.radius + 2 * error)};
  p.error = rounded_up(error);
  p.world_from_part = world_transform(world_from_part);
  return p;
}

}  // namespace clearance::search
