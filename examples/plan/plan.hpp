// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Is a planned trajectory still free in the newest frame, and where is it not?

#include <clearance/make_model.hpp>
#include <clearance/near_maps.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

/// 0 if the gripper stops before the wall, and goes on once it is gone.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> links(2);
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 20; ++i) links[std::size_t(k)].push_back({{0.02f * float(i), 0, 0}, 0.04f});
  std::vector<clearance::vec3> wall;  // about 1.5 m away
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) wall.push_back({1.495f, 0.02f * float(i - 30), 0.02f * float(j - 30)});
  const std::vector<clearance::vec3> room(1, {5, 0, 0});

  // [plan]
  const auto arm = clearance::make_model<clearance::sphere>(links).on(on);
  std::vector<Eigen::Isometry3d> trajectory;  // 100 waypoints, two parts each
  for (int waypoint = 0; waypoint < 100; ++waypoint)
    for (int link = 0; link < 2; ++link) {
      trajectory.push_back(Eigen::Isometry3d::Identity());
      trajectory.back().translation().x() = link * (0.3 + 0.01 * waypoint);  // it reaches out
    }
  clearance::query ask(on, arm, clearance::min_distances{.d_max = 0.2});  // farther away: only that fact is reported
  std::size_t stops = 0;
  for (const auto& frame : {wall, room}) {
    const auto found = ask(trajectory, frame);
    stops = found.first_below(0.05);
    if (stops < found.of.size())
      std::printf("waypoint %zu comes %.3f m near to point %u, with part %u\n", stops, double(found.of[stops].distance),
                  found.of[stops].point, found.of[stops].part);
    else
      std::printf("all %zu waypoints are free, by %.3f m at least\n", found.of.size(), double(found.of[0].lower));
    // [plan]
    if (frame.size() > 1 && stops != 73) return 1;
  }

  // [in_collisions]
  clearance::query touches(on, arm, clearance::in_collisions{{0.05}});  // one state per configuration
  const auto& states = touches(trajectory, wall);
  const std::size_t not_free = states.first_not_free();
  if (not_free < states.of.size())
    std::printf("waypoint %zu is the first that may be within 5 cm: %s\n", not_free, to_string(states.of[not_free]));
  // [in_collisions]
  if (not_free != 73 || clearance::ask(on, arm, trajectory, wall, clearance::in_collisions{{0.05}}).of != states.of)
    return 1;

  // [fields]
  const auto sampled = clearance::with_fields(on, clearance::make_model<clearance::sphere>(links));
  for (const std::string& why_not : sampled.without)
    if (!why_not.empty()) std::printf("no field: %s\n", why_not.c_str());
  const auto there = sampled.model.on(on);
  clearance::query sooner(on, there, clearance::min_distances{.d_max = 0.2});
  // [fields]
  if (sooner(trajectory, wall).first_below(0.05) != 73 || sampled.model.view().fields == nullptr) return 1;

  // [parts]
  const auto each = clearance::ask(on, arm, trajectory, wall, clearance::min_distances_per_part{});
  const auto at_73 = each.of(73);
  std::printf("at waypoint 73 link 0 is %.3f m away, and link 1 %.3f m\n", double(at_73[0].distance),
              double(at_73[1].distance));
  // [parts]
  if (!(at_73[1].distance <= at_73[0].distance && at_73[1].part == 1)) return 1;

  // [joints]
  clearance::chain_link shoulder, slide;  // io::joint_chain_of makes them from a robot description
  slide.origin.m[0][3] = 0.3, slide.value = 0, slide.factor = 1, slide.slides = true;
  const auto chain = clearance::joint_chain<>({shoulder, slide}, {0, 1}, {{"reach", {0, 1}}}).on(on);
  std::vector<double> q;  // two trajectories, one number per waypoint
  for (int waypoint = 0; waypoint < 200; ++waypoint)
    q.push_back(waypoint < 100 ? 0.01 * waypoint : 0.001 * (waypoint - 100));
  const auto of_joints = ask(chain, q, wall);
  const auto first = of_joints.first_below(0.05, 100);
  std::printf("the first trajectory stops at waypoint %zu of 100, the second at %zu\n", first[0], first[1]);
  // [joints]
  return stops == 100 && first[0] == 73 && first[1] == 100 ? 0 : 1;
}
