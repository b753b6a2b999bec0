// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The nearest points of each link, and how far the nearest thing is that is more than a grain of dust.

#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

/// 0 if the dust is the nearest, and the shelf the nearest that is confirmed.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> links(2);
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 20; ++i) links[std::size_t(k)].push_back({{0.02f * float(i), 0.3f * float(k), 0}, 0.04f});
  std::vector<clearance::vec3> seen{{0.1f, 0.36f, 0}};  // a grain of dust, and a shelf
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 50; ++j) seen.push_back({0.005f * float(i), 0.44f, 0.01f * float(j) - 0.25f});

  // [nearest]
  const std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());
  const auto robot = clearance::make_model<clearance::sphere>(links).on(on);
  const auto near = clearance::ask(on, robot, poses, seen, clearance::nearest_k{.k = 100, .d_max = 0.5});
  for (std::size_t k = 0; k < links.size(); ++k)
    std::printf("link %zu: the nearest of 100 is %.3f m away, the last %.3f m\n", k,
                double(near.of(k).front().distance), double(near.of(k).back().distance));

  const auto solid =
      clearance::ask(on, robot, poses, seen, clearance::min_distance_supported{.min_points = 5, .radius = 0.02});
  std::printf("%.3f m to point %u; %llu nearer points are alone, the first %.3f m away\n", double(solid.distance),
              solid.point, static_cast<unsigned long long>(solid.isolated), double(solid.nearest_isolated.distance));
  // [nearest]
  const bool sorted = std::is_sorted(near.of(0).begin(), near.of(0).end(),
                                     [](const auto& a, const auto& b) { return a.distance < b.distance; });
  return sorted && near.of(1)[0].point == 0 && near.of(1)[99].cloud == 0 && solid.isolated == 1 &&
                 solid.nearest_isolated.point == 0 && solid.point > 0 && std::abs(solid.distance - 0.1f) < 1e-3f
             ? 0
             : 1;
}
