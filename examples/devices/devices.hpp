// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud too large for one GPU to be quick about, before an arm: the same lines on CPU threads, one GPU, or several.

#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

inline auto arm_of_two() {
  std::vector<clearance::inner_sphere> row;
  for (int k = 0; k < 64; ++k) row.push_back({{0.004f * float(k), 0, 0}, 0.03f});
  return clearance::make_model<clearance::sphere>(std::vector{row, row});
}
inline std::vector<clearance::vec3> wall() {
  std::vector<clearance::vec3> points;
  for (int k = 0; k < 300000; ++k)
    points.push_back({0.6f, 0.002f * float(k % 600) - 0.6f, 0.002f * float(k / 600) - 0.5f});
  return points;
}
inline std::vector<Eigen::Isometry3d> poses_at(double angle) {
  Eigen::Isometry3d shoulder = Eigen::Isometry3d::Identity(), elbow = shoulder;
  elbow.translate(Eigen::Vector3d(0.25, 0, 0)).rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  return {shoulder, elbow};
}

/// 0 if every answer is the host's. `cloud` may be anything that `on` takes for one.
template <class Backend, class Cloud>
int example(const Backend& on, const Cloud& cloud) {
  const auto on_host = arm_of_two();
  int wrong = 0;
  // [ask]
  const auto arm = on_host.on(on);  // devices: on each of them
  clearance::query ask(on, arm, clearance::min_distance{});
  for (const double angle : {1.5, 1.0, 0.5, 0.0}) {
    const clearance::min_distance_result r = ask(poses_at(angle), cloud);
    std::printf("%.1f rad: %.3f m, certainly more than %.3f m, to point %u of %llu\n", angle, double(r.distance),
                double(r.lower), r.point, static_cast<unsigned long long>(r.seen));
    // [ask]
    const auto same = clearance::ask(clearance::host{}, on_host, poses_at(angle), wall(), clearance::min_distance{});
    wrong += r.distance != same.distance || r.lower != same.lower || r.point != same.point ||
             r.primitive != same.primitive || r.valid != same.valid;
  }
  return wrong;
}
