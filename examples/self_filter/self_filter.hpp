// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A camera sees the arm that it watches, and what the arm holds. How far is the rest?

#include <clearance/compacted.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance_filtered.hpp>
#include <clearance/robot/attached.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

/// 0 if the arm does not mind itself, nor what it holds once that is attached, and the wall is as far as it is.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> links(2), box{{{{0, 0, 0}, 0.03f}}};
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 20; ++i) links[std::size_t(k)].push_back({{0.02f * float(i), 0, 0}, 0.04f});
  std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());
  poses[1].translation().x() = 0.4;
  Eigen::Isometry3d hand = Eigen::Isometry3d::Identity();  // from the last link
  hand.translation().x() = 0.45;
  std::vector<clearance::vec3> seen;  // the arm's upper side, 3 mm off; the box; and a wall
  for (int i = 0; i < 400; ++i) seen.push_back({0.002f * float(i), 0, 0.043f});
  for (int i = 0; i < 10; ++i) seen.push_back({0.85f, 0.003f * float(i) - 0.015f, 0.03f});
  for (int i = 0; i < 400; ++i) seen.push_back({1.2f, 0.01f * float(i % 20), 0.01f * float(i / 20)});

  // [self_filter]
  const auto arm = clearance::make_model<clearance::sphere>(links).on(on);
  const clearance::self_filter filter{.padding = {0.02}};  // metres: noise, calibration, and the gap of the spheres
  const auto bare = clearance::min_distance_filtered(on, arm, poses, seen, filter);

  const auto tool =
      clearance::make_model<clearance::sphere>(box).on(on);  // grasped: one more part, and nothing is built anew
  const auto holding = clearance::attach(on, arm, tool);
  auto its_poses = poses;
  its_poses.push_back(poses[1] * hand);  // world-from-link * link-from-object
  const auto r = clearance::min_distance_filtered(on, holding, its_poses, seen, filter);
  std::printf("%llu of %zu points are the robot's; it is %.3f m from point %u\n", r.filter.counts.own, seen.size(),
              double(r.rest.distance), r.rest.point);
  // [self_filter]

  // [compacted]
  const auto labels = on.copy_in(std::span<const clearance::point_label>(r.filter.labels));
  const auto left = clearance::compacted(on, clearance::masked(clearance::point_span(seen), labels.data()));
  std::printf("%zu points are left for others; the first of them is number %u of the cloud\n", left.points.size(),
              left.numbers.front());
  // [compacted]
  if (left.numbers != r.filter.rest || left.points.size() != left.numbers.size() ||
      left.points.front() != seen[left.numbers.front()])
    return 1;
  return bare.filter.rest.size() == 410 && bare.rest.point >= 400 && bare.rest.point < 410 &&
                 r.filter.counts.own == 410 && r.rest.point >= 410 && std::abs(r.rest.distance - 0.32f) < 1e-4f
             ? 0
             : 1;
}
