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
inline placement place(const part_facts& facts, const Eigen::Isometry3d& world_from_part,
                       const Eigen::Isometry3d& world_from_cloud, vec3 origin) {
  const Eigen::Isometry3d part_from_world = world_from_part.inverse(Eigen::Isometry);
  Eigen::Isometry3d part_from_cloud = part_from_world * world_from_cloud;
  part_from_cloud.translation() = part_from_world * (world_from_cloud * Eigen::Vector3d(origin.x, origin.y, origin.z));
  const Eigen::Vector3d part_center(facts.center.x, facts.center.y, facts.center.z);
  const Eigen::Vector3d center = part_from_cloud.linear().transpose() * (part_center - part_from_cloud.translation());
  const double size = part_center.norm() + facts.radius, away = part_from_cloud.translation().norm();
  const double error = unit_error * 2 * (size + away);
  placement p;
  p.part_from_cloud = to_floats(part_from_cloud);
  p.around = {{real(center.x()), real(center.y()), real(center.z())}, rounded_up(facts.radius + 2 * error)};
  p.error = rounded_up(error);
  p.world_from_part = world_transform(world_from_part);
  return p;
}

/// All parts as seen from one cloud, made on the host for every frame.
struct cloud_frame {
  vec3 origin = {0, 0, 0};
  double error = 0;  ///< The largest of all parts.
  double slop = 0;   ///< The largest gap plus tolerance of all parts.
  std::vector<placement> places;

  cloud_frame() = default;
  /// Throws if a pose is not rigid. `world_from_cloud` is taken as checked.
  cloud_frame(std::span<const part_facts> facts, std::span<const Eigen::Isometry3d> poses,
              const Eigen::Isometry3d& world_from_cloud) {
    put(facts, poses, world_from_cloud);
  }
  /// The same in the memory that is there.
  void put(std::span<const part_facts> facts, std::span<const Eigen::Isometry3d> poses,
             const Eigen::Isometry3d& world_from_cloud) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Isometry3d& pose : poses) middle += pose.translation() / double(poses.size());
    origin = origin_near(world_from_cloud.inverse() * middle);
    error = slop = 0;
    places.clear();
    for (std::size_t k = 0; k < poses.size(); ++k) {
      places.push_back(place(facts[k], rigid(poses[k], "part", std::int64_t(k)), world_from_cloud, origin));
      error = std::max(error, double(places.back().error));
      slop = std::max(slop, double(facts[k].gap) + double(facts[k].tolerance));
    }
  }
};

}  // namespace clearance::search
