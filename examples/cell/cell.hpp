// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Two arms in a cell, a post that is known and a camera: what is nearest to the first arm, and is it near itself?

#include <clearance/make_model.hpp>
#include <clearance/self_distances.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

/// 0 if the nearest thing is the other arm's hand, and the first arm's own hand is nearest to its base.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> links(3);  // a base, an upper arm and a hand
  for (int i = 0; i < 12; ++i) links[0].push_back({{0, 0, 0.05f * float(i)}, 0.06f});
  for (int i = 0; i < 10; ++i) links[1].push_back({{0.05f * float(i), 0, 0}, 0.05f});
  for (int i = 0; i < 6; ++i) links[2].push_back({{0.05f * float(i), 0, 0}, 0.04f});
  const auto arm = clearance::make_model<clearance::sphere>(links).on(on);
  const auto poses_at = [](double x, double shoulder, double elbow) {
    std::vector<Eigen::Isometry3d> all(3, Eigen::Isometry3d::Identity());
    all[0].translation() << x, 0, 0;
    all[1] = all[0] * Eigen::Translation3d(0, 0, 0.6) * Eigen::AngleAxisd(shoulder, Eigen::Vector3d::UnitY());
    all[2] = all[1] * Eigen::Translation3d(0.5, 0, 0) * Eigen::AngleAxisd(elbow, Eigen::Vector3d::UnitY());
    return all;
  };
  const std::vector<Eigen::Isometry3d> poses = poses_at(0, 0, 2.2), others = poses_at(1.6, 3.14, 0);
  std::vector<clearance::vec3> seen;
  for (int i = 0; i < 1000; ++i) seen.push_back({0.05f * float(i % 40) - 1, 0.9f, 0.06f * float(i / 40)});
  const std::vector<clearance::ball> post(1, {{0, -0.8f, 0.5f}, 0.1f});

  // [cell]
  const std::tuple cell{clearance::placed{seen}, clearance::placed{clearance::balls_of(post, 0.002)},
                        as_balls(arm, others)};
  const auto r = clearance::ask(on, arm, poses, cell, clearance::min_distance{});
  if (r.cloud >= 2)
    std::printf("%.3f m from link %u of the other arm, certainly %.3f\n", double(r.distance), r.cloud - 2,
                double(r.lower));

  clearance::part_pairs pairs(arm.size());
  pairs.remove(0, 1).remove(1, 2);               // neighbours touch
  clearance::self_query itself(on, arm, pairs);  // once; then in every frame:
  const clearance::self_distance_result own = itself(poses);
  std::printf("link %u is %.3f m from link %u\n", own.a, double(own.distance), own.b);
  // [cell]

  const auto both = clearance::self_distances(on, arm, std::vector{poses[0], poses[1], poses[2]}, pairs);
  const bool found = r.cloud == 4 && r.lower > 0 && r.lower < r.distance;
  return found && own.a == 0 && own.b == 2 && both.size() == 1 && both[0].b == 2 ? 0 : 1;
}
