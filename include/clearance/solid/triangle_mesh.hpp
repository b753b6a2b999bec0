// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A mesh as it is read or made, before anybody closes it.

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace clearance {

/// Triangles over shared vertices, in metres in the part's own frame; in double, as read from a file or made in code.
struct triangle_mesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// First triangle of each shape in the part, in ascending order and beginning with 0; empty: it is one shape. Each
  /// shape is closed separately.
  std::vector<std::uint32_t> shapes = {};
};

/// Throws std::invalid_argument with the number of the vertex or triangle, if an index is out of range, or a coordinate
/// is not finite or beyond 1e15.
inline void check_corners(const triangle_mesh& mesh) {
  const auto refuse = [](const std::string& why) { throw std::invalid_argument("clearance: the mesh " + why); };
  if (mesh.vertices.size() > 0xfffffff0u || mesh.triangles.size() > 0x3ffffff0u)
    refuse("has too many vertices or triangles");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(mesh.vertices[i][k]) <= 1e15))
        refuse("has a vertex that is not finite or beyond 1e15 m: number " + std::to_string(i));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t v : mesh.triangles[i])
      if (v >= mesh.vertices.size())
        refuse("has an index out of range: triangle " + std::to_string(i) + " names vertex " + std::to_string(v) +
               " of " + std::to_string(mesh.vertices.size()));
}

}  // namespace clearance
