// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A mesh as files hold it, with faces of any number of corners, and its triangles.

#include "solid/polygon.hpp"

#include <clearance/io/error.hpp>
#include <clearance/solid/triangle_mesh.hpp>

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace clearance::io {

/// The content of a mesh file: vertices, and faces of three or more corners, in the file's order.
struct polygon_mesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::uint32_t> corners;  // of all faces in turn
  std::vector<std::size_t> ends;       // where in `corners` each face ends
};

/// How many corners may be looked at in all faces of a file: about ten seconds.
inline constexpr std::size_t usual_patience = 2'000'000'000;

/// One face. What is left of it when `patience` ends must be a fan that lies in it.
inline polygon_triangles cut(const std::vector<Eigen::Vector3d>& vertices, std::span<const std::uint32_t> face,
                             std::size_t& patience, const std::string& file) {
  polygon_triangles triangles = span_polygon(vertices, face, patience, bent_face);
  if (patience == 0 && area_of(vertices, triangles) > bent_face * vector_area(vertices, face).norm())
    refuse(file, "has a face of " + std::to_string(face.size()) +
                     " corners that is too intricate to be cut into triangles here");
  return triangles;
}

/// Triangles in the order of the faces. Indices must be in range. Throws std::runtime_error, naming `file`, if that
/// would take too long.
inline triangle_mesh triangulate(polygon_mesh&& mesh, const std::string& file, std::size_t patience = usual_patience) {
  triangle_mesh made;
  made.vertices = std::move(mesh.vertices);
  std::size_t begin = 0;
  for (const std::size_t end : mesh.ends) {
    const std::span face(mesh.corners.data() + begin, end - begin);
    if (face.size() == 3)
      made.triangles.push_back({face[0], face[1], face[2]});
    else if (face.size() > 3)
      for (const auto& t : cut(made.vertices, face, patience, file)) made.triangles.push_back(t);
    begin = end;
  }
  return made;
}

}  // namespace clearance::io
