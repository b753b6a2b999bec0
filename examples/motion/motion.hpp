// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A gripper carries something past a pole: both ends of the motion are far from it, and the way is not.

#include <clearance/make_model.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

/// 0 if what the motion comes close to is found, and what it does not touch is free.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> bodies(2);  // a hand, and a bar in it
  for (int i = 0; i < 10; ++i) bodies[0].push_back({{0, 0, 0.01f * float(i)}, 0.04f});
  for (int i = -10; i <= 10; ++i) bodies[1].push_back({{0.02f * float(i), 0, -0.05f}, 0.02f});
  std::vector<clearance::vec3> pole_points;
  for (int i = 0; i < 400; ++i) pole_points.push_back({0, 0.3f, 0.005f * float(i) - 1});
  std::vector<Eigen::Isometry3d> here(2, Eigen::Isometry3d::Identity()), there = here;
  for (auto& pose : here) pose.translation() << -1, 0, 0;
  for (auto& pose : there) pose.translation() << 1, 0, 0, pose.rotate(Eigen::AngleAxisd(3, Eigen::Vector3d::UnitZ()));
  const auto robot = clearance::make_model<clearance::sphere>(bodies).on(on);
  const auto pole = on.copy_in(std::span<const clearance::vec3>(pole_points));  // asked many times: where it is read
  const clearance::point_span points(pole.data(), pole_points.size());

  // [motion]
  const clearance::straight_motion motion(here, there);
  const auto r = clearance::motion_clearance(on, robot, motion, points, {.tolerance = 0.005, .margin = 0.1});
  std::printf(
      "%s: certainly at least %.3f m away all the way; at time %.3f the %s is at most %.3f m from point %u (%zu "
      "questions)\n",
      to_string(r.state), double(r.lower), r.time, r.nearest.part == 1 ? "bar" : "hand", double(r.upper),
      r.nearest.point, r.queries);
  if (!(r.lower > 0.1)) std::printf("another way is needed between %.3f and %.3f\n", r.from, r.to);
  // [motion]

  const auto ends = std::min(clearance::ask(on, robot, here, points, clearance::min_distance{}).lower,
                             clearance::ask(on, robot, there, points, clearance::min_distance{}).lower);
  const auto enough =
      clearance::motion_clearance(on, robot, motion, points, {.tolerance = clearance::infinity, .margin = 0.1});
  const bool found = r.state == clearance::state::collision && r.lower <= r.upper && r.upper < 0.1 && ends > 0.8f;
  return found && enough.state != clearance::state::free && enough.queries <= r.queries ? 0 : 1;
}
