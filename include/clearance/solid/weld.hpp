// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/triangle_mesh.hpp>

#include <Eigen/Geometry>

#include <bit>
#include <cmath>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <unordered_map>

namespace clearance {

/// Throws std::invalid_argument with the number of the vertex or triangle, if this is no mesh: no triangles, an index
/// out of range, a coordinate that is not finite or beyond 1e15, or no triangle with an area.
inline void check_mesh(const triangle_mesh& mesh) {
  const auto refuse = [](const std::string& why) { throw std::invalid_argument("clearance: the mesh " + why); };
  if (mesh.triangles.empty()) refuse("has no triangles");
  if (mesh.vertices.size() > 0xfffffff0u || mesh.triangles.size() > 0x3ffffff0u)
    refuse("has too many vertices or triangles");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(mesh.vertices[i][k]) <= 1e15))
        refuse("has a vertex that is not finite or beyond 1e15 m: number " + std::to_string(i));
  bool area = false;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    for (const std::uint32_t v : t)
      if (v >= mesh.vertices.size())
        refuse("has an index out of range: triangle " + std::to_string(i) + " names vertex " + std::to_string(v) +
               " of " + std::to_string(mesh.vertices.size()));
    const Eigen::Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    area = area || (b - a).cross(c - a).squaredNorm() > 0;
  }
  if (!area) refuse("is degenerate: none of its " + std::to_string(mesh.triangles.size()) + " triangles has an area");
}

/// Merges vertices with equal coordinates into the first of them; 0 and -0 are equal. Keeps their order, and drops
/// vertices that no triangle uses.
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

/// Merges those of these vertices that are within `reach` metres of an earlier one; returns how many. Each is compared
/// with the first of its group, so a row of close ones does not shrink to a point.
inline std::size_t weld_near(triangle_mesh& mesh, std::span<const std::uint32_t> vertices, double reach) {
  struct cell_hash {
    std::size_t operator()(const std::array<std::int64_t, 3>& cell) const {
      std::uint64_t h = 0;
      for (const std::int64_t c : cell) h = (h ^ std::uint64_t(c)) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
      return h;
    }
  };
  std::unordered_map<std::array<std::int64_t, 3>, std::vector<std::uint32_t>, cell_hash> kept;
  std::vector<std::uint32_t> number(mesh.vertices.size());
  std::iota(number.begin(), number.end(), 0u);
  std::size_t moved = 0;
  for (const std::uint32_t v : vertices) {
    const Eigen::Vector3d &p = mesh.vertices[v], at = (p - mesh.vertices[vertices[0]]) / reach;
    const std::array<std::int64_t, 3> cell{std::llround(at.x()), std::llround(at.y()), std::llround(at.z())};
    const std::uint32_t* found = nullptr;
    for (int k = 0; k < 27 && !found; ++k)
      if (const auto near = kept.find({cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1});
          near != kept.end())
        for (const std::uint32_t& other : near->second)
          if ((mesh.vertices[other] - p).norm() <= reach && !found) found = &other;
    if (found)
      number[v] = *found, ++moved;
    else
      kept[cell].push_back(v);
  }
  for (auto& t : mesh.triangles)
    for (std::uint32_t& v : t) v = number[v];
  return moved;
}

}  // namespace clearance
