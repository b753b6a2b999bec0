// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Triangles in axis-aligned boxes: how near does a depth image come to a cube? The same source on CPU and GPU.

#include <clearance/make_model.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/solid/close_mesh.hpp>
#include <clearance/volume/aabb.hpp>

#include <cstdio>

/// A cube of half width `h`.
inline clearance::triangle_mesh cube(double h) {
  clearance::triangle_mesh mesh;
  for (int k = 0; k < 8; ++k) mesh.vertices.emplace_back(k & 1 ? h : -h, k & 2 ? h : -h, k & 4 ? h : -h);
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

template <clearance::backend Backend>
int example(const Backend& on) {
  // A camera at the world's origin sees a wall 2 m away, a finger at pixel (40, 20), and nothing at pixel 0.
  std::vector<std::uint16_t> pixels(64 * 48, 2000);  // millimetres
  pixels[20 * 64 + 40] = 1200, pixels[0] = 0;
  const clearance::intrinsics camera{.fx = 60, .fy = 60, .cx = 31.5, .cy = 23.5};
  const clearance::depth_image<std::uint16_t> image(pixels.data(), 64, 48, camera, 0.001);

  const auto part = clearance::make_part<clearance::aabb>(clearance::close_mesh(cube(0.1))).on(on);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << 0.1, 0, 0.8;  // world from part

  const clearance::min_distance_result r = clearance::ask(on, part, pose, image, clearance::min_distance{});
  std::printf("%.6f m to pixel (%u, %u), of %u that are valid\n", r.distance, r.point % 64, r.point / 64,
              unsigned(r.valid));
  // The finger is nearest, and straight in front of the cube's front face, which is at z = 0.9.
  const bool right = std::abs(r.distance - 0.3f) < 1e-6f && r.point == 20 * 64 + 40 && r.valid == 64 * 48 - 1;

  pose.translation().z() = 1.2;  // now the finger is inside: the cube is closed, so that is noticed
  const bool noticed =
      clearance::ask(on, part, pose, image, clearance::min_distance{}).state == clearance::state::collision;
  return right && noticed && r.state == clearance::state::free ? 0 : 1;
}
