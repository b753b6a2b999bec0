// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A robot in a loop: the prepared query keeps its scratch memory, and where the last minimum was, from frame to frame.

#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<clearance::inner_sphere> row;
  for (int k = 0; k < 64; ++k) row.push_back({{0.004f * k, 0, 0}, 0.03f});
  const auto link = clearance::make_part(clearance::build<clearance::sphere>(row));
  std::vector<clearance::vec3> wall;
  for (int k = 0; k < 10000; ++k) wall.push_back({0.5f, 0.01f * (k % 100) - 0.5f, 0.01f * (k / 100) - 0.5f});

  // [frames]
  const auto arm = clearance::model(std::vector{link, link}).on(on);  // once
  clearance::query ask(on, arm, clearance::min_distance{});
  int stops = 0;
  for (int frame = 0; frame < 20; ++frame) {  // new poses and new points in every frame
    Eigen::Isometry3d shoulder = Eigen::Isometry3d::Identity(), elbow = shoulder;
    elbow.translate(Eigen::Vector3d(0.25, 0, 0)).rotate(Eigen::AngleAxisd(1.5 - 0.1 * frame, Eigen::Vector3d::UnitZ()));
    const clearance::min_distance_result r = ask(std::vector{shoulder, elbow}, wall);
    if (!(r.lower > 0.05)) ++stops;  // also if there was no valid point
    // [frames]
    const auto same = clearance::ask(clearance::host{}, clearance::model(std::vector{link, link}),
                                     std::vector{shoulder, elbow}, wall, clearance::min_distance{});
    if (r.distance != same.distance || r.point != same.point || r.primitive != same.primitive) return 1;
  }
  std::printf("%d of 20 frames were too close\n", stops);
  return stops > 0 && stops < 20 ? 0 : 1;
}
