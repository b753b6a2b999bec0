// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a depth image hides, as a mesh to be drawn.

#include <clearance/points/depth_image.hpp>
#include <clearance/points/hidden.hpp>
#include <clearance/solid/triangle_mesh.hpp>

#include <span>

namespace clearance::io {

/// The room that an image hides, in the camera's frame, metres: its walls, in at most `most` blocks of pixels. Of a
/// block it shows the nearest room that a pixel hides. Pixels that `labels` (one per pixel, or none) call the robot's
/// own hide nothing.
template <class Pixel>
triangle_mesh hidden_mesh(const depth_image<Pixel>& image, const hiding& room, std::span<const point_label> labels = {},
                          std::size_t most = 6000) {
  const hidden<depth_image<Pixel>> source{image, room, 0};
  std::uint32_t step = 1;  // pixels along a block
  const auto blocks = [&](std::uint32_t pixels) { return (pixels + step - 1) / step; };
  while (std::size_t(blocks(image.width)) * blocks(image.height) > most) ++step;
  const std::uint32_t width = blocks(image.width), height = blocks(image.height);

  const double farthest = room.farthest;
  std::vector<double> from(std::size_t(width) * height, farthest);  // where each block's room begins
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (!labels.empty() && labels[i] == point_label::own) continue;
    const std::size_t u = i % image.width / step, v = i / image.width / step;
    if (const sample s = source[i]; s.valid())
      from[v * width + u] = std::min(from[v * width + u], double(s.position.z));
  }

  const auto begin = [&](std::int64_t u, std::int64_t v) {  // beside the image nothing is drawn
    return u < 0 || v < 0 || u >= width || v >= height ? farthest : from[std::size_t(v) * width + std::size_t(u)];
  };
  const auto corner = [&](std::int64_t u, std::int64_t v, double z) {
    const double x = std::min<double>(double(u * step), image.width) - 0.5 - double(image.cx),
                 y = std::min<double>(double(v * step), image.height) - 0.5 - double(image.cy);
    return Eigen::Vector3d(x * double(image.inverse_fx) * z, y * double(image.inverse_fy) * z, z);
  };

  triangle_mesh mesh;
  const auto wall = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                        const Eigen::Vector3d& d) {
    const auto first = std::uint32_t(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {a, b, c, d});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  };
  const auto between = [&](double z, double beside, const auto& at) {  // of two blocks, at their common edge
    if (z != beside) wall(at(0, z), at(1, z), at(1, beside), at(0, beside));
  };

  for (std::int64_t v = 0; v <= height; ++v)
    for (std::int64_t u = 0; u <= width; ++u) {
      const double z = begin(u, v);
      if (v < height) between(z, begin(u - 1, v), [&](int end, double at) { return corner(u, v + end, at); });
      if (u < width) between(z, begin(u, v - 1), [&](int end, double at) { return corner(u + end, v, at); });
      if (!(z < farthest)) continue;
      for (const double plane : {z, farthest})
        wall(corner(u, v, plane), corner(u + 1, v, plane), corner(u + 1, v + 1, plane), corner(u, v + 1, plane));
    }
  return mesh;
}

}  // namespace clearance::io
