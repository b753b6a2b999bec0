// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Triangles in axis-aligned boxes: how near does a depth image come to a cube? The same source on CPU and GPU.

#include <clearance/bvh/build.hpp>
#include <clearance/min_distance.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/primitive/triangle.hpp>
#include <clearance/volume/aabb.hpp>

#include <cstdio>

/// The surface of a cube of half width `h`: two triangles a face.
inline std::vector<clearance::triangle> cube(float h) {
  std::vector<clearance::triangle> faces;
  for (int k = 0; k < 3; ++k)
    for (const float side : {-h, h}) {
      const auto corner = [&](float u, float v) {
        float c[3];
        c[k] = side, c[(k + 1) % 3] = u, c[(k + 2) % 3] = v;
        return clearance::vec3{c[0], c[1], c[2]};
      };
      faces.push_back(clearance::triangle::from(corner(-h, -h), corner(h, -h), corner(h, h)));
      faces.push_back(clearance::triangle::from(corner(-h, -h), corner(h, h), corner(-h, h)));
    }
  return faces;
}

template <clearance::backend Backend>
int example(const Backend& on) {
  // A camera at the world's origin sees a wall 2 m away, a finger at pixel (40, 20), and nothing at pixel 0.
  std::vector<std::uint16_t> pixels(64 * 48, 2000);  // millimetres
  pixels[20 * 64 + 40] = 1200, pixels[0] = 0;
  const clearance::intrinsics camera{.fx = 60, .fy = 60, .cx = 31.5, .cy = 23.5};
  const clearance::depth_image<std::uint16_t> image(pixels.data(), 64, 48, camera, 0.001);

  const auto part = clearance::make_part(clearance::build<clearance::aabb>(cube(0.1f))).on(on);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << 0.1, 0, 0.8;  // world from part

  const clearance::min_distance_result r = clearance::min_distance(on, part, pose, image);
  std::printf("%.6f m to pixel (%u, %u), of %u that are valid\n", r.distance, r.point % 64, r.point / 64, unsigned(r.valid));

  // The finger is nearest, and straight in front of the cube's front face, which is at z = 0.9.
  const bool right = std::abs(r.distance - 0.3f) < 1e-6f && r.point == 20 * 64 + 40 && r.valid == 64 * 48 - 1;
  return right && r.state == clearance::state::free ? 0 : 1;
}
