// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/triangle_mesh.hpp>

#include <Eigen/Geometry>

#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>
#include <unordered_map>

namespace clearance {

/// Throws std::invalid_argument, with the number of the vertex or triangle, if this is no mesh: no triangles, an index
/// out of range, a coordinate that is not finite or beyond 1e15, or no triangle with an area.
inline void check_mesh(const triangle_mesh& mesh) {
  const auto refuse = [](const std::string& why) { throw std::invalid_argument("clearance: the mesh " + why); };
  if (mesh.triangles.empty()) refuse("has no triangles");
  if (mesh.vertices.size() > 0xfffffff0u || mesh.triangles.size() > 0x3ffffff0u) refuse("has too many vertices or triangles");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(mesh.vertices[i][k]) <= 1e15))
        refuse("has a vertex that is not finite or beyond 1e15 m: number " + std::to_string(i));
  bool area = false;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    for (const std::uint32_t v : t)
      if (v >= mesh.vertices.size())
        refuse("has an index out of range: triangle " + std::to_string(i) + " names vertex " + std::to_string(v) + " of " +
               std::to_string(mesh.vertices.size()));
    const Eigen::Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    area = area || (b - a).cross(c - a).squaredNorm() > 0;
  }
  if (!area) refuse("is degenerate: none of its " + std::to_string(mesh.triangles.size()) + " triangles has an area");
}

/// Vertices with equal coordinates become one, the first of them; 0 and -0 are equal. Vertices keep their order, and
/// those that no triangle uses are left out.
inline triangle_mesh weld(const triangle_mesh& mesh) {
  struct hash {
    std::size_t operator()(const Eigen::Vector3d& v) const {
      std::uint64_t h = 0;
      for (int k = 0; k < 3; ++k) {
        h = (h ^ std::bit_cast<std::uint64_t>(v[k] + 0.0)) * 0x9e3779b97f4a7c15u;  // -0.0 + 0.0 is 0.0
        h ^= h >> 29;
      }
      return h;
    }
  };
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) used[v] = true;
  triangle_mesh welded{{}, mesh.triangles};
  std::unordered_map<Eigen::Vector3d, std::uint32_t, hash> known;
  std::vector<std::uint32_t> number(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!used[i]) continue;
    const auto [place, is_new] = known.try_emplace(mesh.vertices[i], std::uint32_t(welded.vertices.size()));
    if (is_new) welded.vertices.push_back(mesh.vertices[i]);
    number[i] = place->second;
  }
  for (auto& t : welded.triangles)
    for (std::uint32_t& v : t) v = number[v];
  return welded;
}

}  // namespace clearance
