// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/scene_mesh.hpp>

#include <algorithm>
#include <map>
#include <numeric>

namespace clearance::io {

/// A unit sphere: an icosahedron whose triangles are each cut into four, `cuts` times.
inline triangle_mesh icosphere(int cuts) {
  constexpr double g = 1.6180339887498949;
  triangle_mesh mesh;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-g, g}) {
      mesh.vertices.emplace_back(0, a, b);
      mesh.vertices.emplace_back(a, b, 0);
      mesh.vertices.emplace_back(b, 0, a);
    }
  for (auto& v : mesh.vertices) v.normalize();
  const auto near = [&](std::uint32_t i, std::uint32_t k) { return mesh.vertices[i].dot(mesh.vertices[k]) > 0.4; };
  for (std::uint32_t i = 0; i < 12; ++i)
    for (std::uint32_t j = i + 1; j < 12; ++j)
      for (std::uint32_t k = j + 1; k < 12; ++k) {
        if (!near(i, j) || !near(j, k) || !near(k, i)) continue;
        const bool outward = mesh.vertices[i].cross(mesh.vertices[j]).dot(mesh.vertices[k]) > 0;
        mesh.triangles.push_back({i, outward ? j : k, outward ? k : j});
      }
  for (; cuts > 0; --cuts) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known;
    const auto middle = [&](std::uint32_t i, std::uint32_t k) {
      const auto [at, is_new] = known.try_emplace(std::minmax(i, k), std::uint32_t(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back((mesh.vertices[i] + mesh.vertices[k]).normalized());
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& t : {std::array{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}}) finer.push_back(t);
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

/// Smoothly shaded balls. Only the largest are fine, so that viewers can open a file with thousands of them.
inline drawn_mesh faces_of(const std::vector<ball>& balls) {
  static const triangle_mesh shapes[4] = {icosphere(0), icosphere(1), icosphere(2), icosphere(3)};
  std::vector<std::size_t> order(balls.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return balls[a].radius > balls[b].radius; });
  const auto shape = [](std::size_t rank) -> const triangle_mesh& {
    return shapes[rank < 1 ? 3 : rank < 6 ? 2 : rank < 48 ? 1 : 0];
  };
  drawn_mesh out;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const ball& b = balls[order[i]];
    const auto first = std::uint32_t(out.positions.size());
    for (const auto& t : shape(i).triangles)
      for (const std::uint32_t corner : t) out.corners.push_back(first + corner);
    for (const auto& n : shape(i).vertices) {
      out.normals.push_back(to_vec3(n));
      const vec3 m = out.normals.back();
      out.positions.push_back({b.center.x + b.radius * m.x, b.center.y + b.radius * m.y, b.center.z + b.radius * m.z});
    }
  }
  return out;
}

}  // namespace clearance::io
