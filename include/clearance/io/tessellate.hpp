// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/triangle_mesh.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

namespace clearance::io {

/// A closed mesh that faces out, with its vertices on the shape's surface: it is inscribed, so that the shape reaches
/// nowhere farther than `error` metres beyond it, and nowhere less far.
struct tessellation {
  triangle_mesh mesh;
  double error = 0;
};

/// Twelve triangles; exact.
inline tessellation tessellate_box(const Eigen::Vector3d& size) {
  tessellation made;
  for (int i = 0; i < 8; ++i)
    made.mesh.vertices.push_back(0.5 *
                                 size.cwiseProduct(Eigen::Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  made.mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                         {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return made;
}

/// Along z, its middle at the origin. As many sides as keep the error below `tolerance`, though at most 4096.
inline tessellation tessellate_cylinder(double radius, double length, double tolerance = 1e-4) {
  using std::numbers::pi;
  const double half_angle = std::acos(std::clamp(1 - tolerance / radius, -1.0, 1.0));
  const auto n = std::uint32_t(std::clamp(std::ceil(pi / std::max(half_angle, 1e-9)), 12.0, 4096.0));
  tessellation made;
  made.error = radius * (1 - std::cos(pi / n)) + 1e-15 * (radius + length);  // the second for rounding
  made.mesh.vertices = {{0, 0, -0.5 * length}, {0, 0, 0.5 * length}};
  for (std::uint32_t i = 0; i < n; ++i) {
    const double x = radius * std::cos(2 * pi * i / n), y = radius * std::sin(2 * pi * i / n);
    made.mesh.vertices.emplace_back(x, y, -0.5 * length);
    made.mesh.vertices.emplace_back(x, y, 0.5 * length);
    const std::uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % n);
    made.mesh.triangles.insert(made.mesh.triangles.end(),
                               {{a, b, b + 1}, {a, b + 1, a + 1}, {0, b, a}, {1, a + 1, b + 1}});
  }
  return made;
}

/// Around the origin: an icosahedron, its faces split evenly until the error is below `tolerance`, though into at most
/// 128 by 128 each.
inline tessellation tessellate_sphere(double radius, double tolerance = 1e-4) {
  const double g = std::numbers::phi;
  const std::array<Eigen::Vector3d, 12> corner{{{-1, g, 0},
                                                {1, g, 0},
                                                {-1, -g, 0},
                                                {1, -g, 0},
                                                {0, -1, g},
                                                {0, 1, g},
                                                {0, -1, -g},
                                                {0, 1, -g},
                                                {g, 0, -1},
                                                {g, 0, 1},
                                                {-g, 0, -1},
                                                {-g, 0, 1}}};
  constexpr std::uint32_t faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                          {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                          {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                          {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  // In the middle of a face, where triangles are largest, the error is 0.292 radius / n^2.
  const auto n = std::uint32_t(std::clamp(std::ceil(std::sqrt(0.292 * radius / tolerance)), 2.0, 128.0));
  tessellation made;
  // Faces share the vertices on their edges: a vertex is known by its corners and their weights.
  std::map<std::array<std::uint32_t, 6>, std::uint32_t> known;
  for (const auto& face : faces) {
    const auto vertex = [&](std::uint32_t i, std::uint32_t j) {
      std::array<std::pair<std::uint32_t, std::uint32_t>, 3> parts{{{face[0], n - i - j}, {face[1], i}, {face[2], j}}};
      for (auto& [c, weight] : parts) c = weight ? c : 0;
      std::sort(parts.begin(), parts.end());
      const std::array<std::uint32_t, 6> key{parts[0].first,  parts[0].second, parts[1].first,
                                             parts[1].second, parts[2].first,  parts[2].second};
      const auto [at, is_new] = known.try_emplace(key, std::uint32_t(made.mesh.vertices.size()));
      if (is_new) {
        Eigen::Vector3d v = Eigen::Vector3d::Zero();
        for (const auto& [c, weight] : parts) v += double(weight) * corner[c];
        made.mesh.vertices.push_back(radius * v.normalized());
      }
      return at->second;
    };
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = 0; i + j < n; ++j) {
        made.mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
        if (i + j + 1 < n) made.mesh.triangles.push_back({vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
      }
  }
  for (const auto& [a, b, c] : made.mesh.triangles) {  // from the sphere to each triangle's plane
    const Eigen::Vector3d& p = made.mesh.vertices[a];
    const Eigen::Vector3d normal = (made.mesh.vertices[b] - p).cross(made.mesh.vertices[c] - p).normalized();
    made.error = std::max(made.error, radius - normal.dot(p));
  }
  made.error += 1e-15 * radius;
  return made;
}

}  // namespace clearance::io
