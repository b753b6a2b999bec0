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
/// And by this, because squares of lengths below 1e-19 m lose digits, and those of lengths below 2e-23 m are 0.
inline constexpr double underflow_error = 0x1p-72;

/// Where the cloud's coordinates start to be subtracted: near the robot, in steps of 64 m, so that ordinary scenes lose
/// nothing and clouds in world coordinates of 1e6 m no more than their own coordinates have lost.
CLEARANCE_HD inline vec3 origin_near(position robot_in_cloud) {
  const auto step = [](double x) { return real(round(x / 64) * 64); };
  return {step(robot_in_cloud.x), step(robot_in_cloud.y), step(robot_in_cloud.z)};
}

/// The mean of the parts' origins, in the cloud's frame.
CLEARANCE_HD inline position middle_of(const world_transform& world_from_cloud, const world_transform* world_from_part, std::size_t parts) {
  position sum{0, 0, 0};
  for (std::size_t k = 0; k < parts; ++k) {
    const position at = world_from_part[k].translation();
    sum = {sum.x + at.x, sum.y + at.y, sum.z + at.z};
  }
  return world_from_cloud.inverse()(position{sum.x / double(parts), sum.y / double(parts), sum.z / double(parts)});
}

/// `part_from_cloud` maps positions that `origin` was subtracted from. Both transforms have passed make_rigid.
CLEARANCE_HD inline placement place(const part_facts& facts, const world_transform& world_from_part, const world_transform& world_from_cloud,
                                    vec3 origin) {
  const world_transform part_from_world = world_from_part.inverse();
  world_transform part_from_cloud = part_from_world * world_from_cloud;
  const position start = part_from_world(world_from_cloud(origin));
  part_from_cloud.m[0][3] = start.x, part_from_cloud.m[1][3] = start.y, part_from_cloud.m[2][3] = start.z;
  const auto norm = [](position p) { return sqrt(fma(p.x, p.x, fma(p.y, p.y, p.z * p.z))); };
  const position center = part_from_cloud.inverse()(facts.center);
  const double size = norm({facts.center.x, facts.center.y, facts.center.z}) + facts.radius, away = norm(start);
  const double error = fma(unit_error * 2, size + away, underflow_error);
  placement p;
  p.part_from_cloud = to_floats(part_from_cloud);
  p.around = {{real(center.x), real(center.y), real(center.z)}, rounded_up(facts.radius + 2 * error)};
  p.error = rounded_up(error);
  p.world_from_part = world_from_part;
  return p;
}

/// What all parts of a frame have in common.
struct frame_facts {
  world_transform world_from_cloud;
  vec3 origin = {0, 0, 0};
  double error = 0;  ///< The largest `placement::error`,
  double slop = 0;   ///< and the largest gap plus tolerance, of all parts.

  CLEARANCE_HD void add(const part_facts& facts, const placement& place) {
    const double its = double(facts.gap) + double(facts.tolerance);
    error = place.error > error ? place.error : error;
    slop = its > slop ? its : slop;
  }
};

/// All parts as seen from one cloud, made on the host for every frame; kept, it allocates only once.
struct cloud_frame : frame_facts {
  std::vector<placement> places;
  std::vector<world_transform> poses;

  /// Throws if a pose is not rigid. `world_from_cloud` is taken as checked.
  void put(std::span<const part_facts> facts, std::span<const Eigen::Isometry3d> parts, const world_transform& cloud) {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__FMA__)
    // Without -mfma each fma is a call, which makes a frame's poses cost microseconds. Same bits, either way.
    if (__builtin_cpu_supports("fma")) return put_with_fma(facts, parts, cloud);
#endif
    put_plain(facts, parts, cloud);
  }
  void put(std::span<const part_facts> facts, std::span<const Eigen::Isometry3d> parts, const Eigen::Isometry3d& cloud) {
    put(facts, parts, world_transform(cloud));
  }
  cloud_frame() = default;
  cloud_frame(std::span<const part_facts> facts, std::span<const Eigen::Isometry3d> parts, const Eigen::Isometry3d& cloud) {
    put(facts, parts, world_transform(cloud));
  }

 private:
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__FMA__)
  __attribute__((target("fma"), flatten)) void put_with_fma(std::span<const part_facts> facts, std::span<const Eigen::Isometry3d> parts,
                                                            const world_transform& cloud) {
    put_plain(facts, parts, cloud);
  }
#endif
  void put_plain(std::span<const part_facts> facts, std::span<const Eigen::Isometry3d> parts, const world_transform& cloud) {
    world_from_cloud = cloud, error = slop = 0;
    poses.clear(), places.clear();
    for (std::size_t k = 0; k < parts.size(); ++k) poses.push_back(rigid_transform_of(parts[k], "part", std::int64_t(k)));
    origin = origin_near(middle_of(world_from_cloud, poses.data(), poses.size()));
    for (std::size_t k = 0; k < parts.size(); ++k) {
      places.push_back(place(facts[k], poses[k], world_from_cloud, origin));
      add(facts[k], places.back());
    }
  }
};

}  // namespace clearance::search
