// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which way is away? Two links step back from a wall along the gradient of their clearance.

#include <clearance/gradient.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

/// 0 if each step does what the gradient says.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> links(2);
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 20; ++i) links[std::size_t(k)].push_back({{0.02f * float(i), 0.3f * float(k), 0}, 0.04f});
  std::vector<clearance::vec3> wall;
  for (int i = 0; i < 101; ++i)
    for (int j = 0; j < 101; ++j) wall.push_back({0.6f, 0.01f * float(i) - 0.35f, 0.01f * float(j) - 0.5f});
  std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());
  poses[1].translation().x() = 0.02;
  const auto robot = clearance::make_model<clearance::sphere>(links).on(on);

  int wrong = 0;
  double before = 0;
  for (int step = 0; step < 3; ++step) {
    // [gradient]
    const auto [least, minima] = clearance::ask(on, robot, poses, wall, clearance::min_distance_per_part{});
    const auto g = clearance::gradient(least, Eigen::Vector3d(poses[least.part].translation()));
    if (!g) return std::printf("no gradient: %s\n", to_string(g.state)), 1;
    std::printf("link %u is %.3f m away, and a metre along (%.2f, %.2f, %.2f) takes it a metre farther\n", least.part,
                double(least.distance), double(g.linear.x), double(g.linear.y), double(g.linear.z));

    // Both links count, the nearer more: no jump where they change places. 2 cm is how much of a difference matters.
    const auto smooth = clearance::smooth_minimum_of(minima, 0.02);
    const auto witnesses = clearance::ask(on, robot, poses, wall, clearance::part_witnesses{minima});
    Eigen::Vector3d away = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < witnesses.size(); ++k)
      if (const auto its = clearance::gradient(witnesses[k], Eigen::Vector3d(poses[k].translation())))
        away += smooth.weights[k] * Eigen::Vector3d(its.linear.x, its.linear.y, its.linear.z);
    for (auto& pose : poses) pose.translation() += 0.05 * away;
    // [gradient]
    wrong += smooth.value > double(least.distance) || std::abs(away.x() + 1) > 1e-3 ||
             (step > 0 && std::abs(smooth.value - before - 0.05) > 1e-4);
    before = smooth.value;
  }
  return wrong;
}
