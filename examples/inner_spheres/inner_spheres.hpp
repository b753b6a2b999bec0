// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From a mesh to a distance with a certificate: inner spheres in bounding spheres.

#include <clearance/make_model.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

template <clearance::backend Backend>
int example(const Backend& on) {
  // A box of 8 x 6 x 4 cm. Meshes of real links come from io::load_mesh and io::load_robot.
  clearance::triangle_mesh box;
  for (int k = 0; k < 8; ++k)
    box.vertices.emplace_back(k & 1 ? 0.04 : -0.04, k & 2 ? 0.03 : -0.03, k & 4 ? 0.02 : -0.02);
  box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};

  // [pack]
  const clearance::packing packed = clearance::pack(box, {.count = 200});
  std::printf("%zu spheres fill %.0f %% of the box; no point of it is more than %.2f mm from them\n",
              packed.spheres.size(), 100 * packed.fill, 1000 * packed.gap);
  const auto part = clearance::make_part<clearance::sphere>(packed).on(on);
  // [pack]

  // A point 5 cm above the middle of the box's upper face; then another one, inside.
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  std::vector<clearance::vec3> cloud = {{0, 0, 0.07f}};
  const auto outside = clearance::ask(on, part, pose, cloud, clearance::min_distance{});
  cloud.push_back({0.01f, 0, 0});
  const auto inside = clearance::ask(on, part, pose, cloud, clearance::min_distance{});
  for (const auto& r : {outside, inside})
    std::printf("%-9s %9.6f m to the spheres, certainly %.6f m to %.6f m to the box\n", clearance::to_string(r.state),
                r.distance, r.lower, r.upper);

  const bool certain = outside.lower <= 0.05f && 0.05f <= outside.upper && outside.state == clearance::state::free;
  return certain && inside.distance < 0 && inside.upper == 0 && inside.state == clearance::state::collision ? 0 : 1;
}
