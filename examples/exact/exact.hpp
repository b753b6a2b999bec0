// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How deep is a tool in what the camera sees? Signed distances to closed meshes, exact on both sides of the surface.

#include <clearance/make_model.hpp>
#include <clearance/questions/signed_distances.hpp>
#include <clearance/volume/aabb.hpp>

#include <cmath>
#include <cstdio>

/// 0 if every depth is the one that is known of a box.
template <clearance::backend Backend>
int example(const Backend& on) {
  clearance::triangle_mesh block;  // 10 x 10 x 30 cm
  for (int k = 0; k < 8; ++k) block.vertices.emplace_back(k & 1 ? 0.05 : -0.05, k & 2 ? 0.05 : -0.05, k & 4 ? 0.3 : 0);
  block.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  std::vector<clearance::vec3> bench;  // the plane 2 cm above the lower end of the block, which has gone through it
  for (int i = -100; i <= 100; ++i)
    for (int j = -100; j <= 100; ++j) bench.push_back({0.002f * float(i), 0.002f * float(j), 0.02f});

  // [exact]
  const auto tool = clearance::make_model<clearance::aabb>(std::vector{clearance::close_mesh(block)}).on(on);
  const std::vector<Eigen::Isometry3d> poses(1, Eigen::Isometry3d::Identity());
  const auto all = clearance::ask(on, tool, poses, bench, clearance::signed_distances{.d_max = 0.1, .which = true});
  const auto inside = std::ranges::count_if(all.distance, [](clearance::real d) { return d < 0; });
  const auto deepest = std::size_t(std::ranges::min_element(all.distance) - all.distance.begin());
  std::printf("%zd of %zu points are inside; the deepest is %.1f mm from triangle %u\n", std::ptrdiff_t(inside),
              bench.size(), -1e3 * double(all.distance[deepest]), all.primitive[deepest]);
  // [exact]
  int wrong = 0;
  for (std::size_t i = 0; i < bench.size(); ++i) {
    const auto [x, y, z] = bench[i];
    const double dx = std::abs(x) - 0.05, dy = std::abs(y) - 0.05;
    const double known =
        dx < 0 && dy < 0 ? -std::min({-dx, -dy, double(z)}) : std::hypot(std::max(dx, 0.0), std::max(dy, 0.0));
    wrong += known < 0.0999 && !(std::abs(all.distance[i] - known) < 1e-6);
  }
  return wrong == 0 ? 0 : 1;
}
