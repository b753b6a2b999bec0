// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

/// Cuts one flat polygon into triangles by clipping ears. A polygon that crosses itself, or has no area, becomes a fan:
/// that keeps its boundary, and so the winding numbers around it. The search takes the square of the number of corners;
/// when it has used up `patience`, what is left must be a fan that turns one way. Returns false if it is not.
inline bool clip_ears(const std::vector<Eigen::Vector3d>& vertices, std::span<const std::uint32_t> face,
                      std::vector<std::array<std::uint32_t, 3>>& triangles, std::size_t& patience) {
  std::vector<std::uint32_t> left(face.begin(), face.end());
  const Eigen::Vector3d base = vertices[face[0]];  // a face far from the origin keeps its digits
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < face.size(); ++i)
    normal += (vertices[face[i]] - base).cross(vertices[face[i + 1]] - base);
  const auto turn = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return normal.dot((vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]));
  };
  std::size_t tried = 0;
  for (std::size_t i = 1; left.size() > 3 && tried < left.size() && patience > 0;) {
    const std::size_t n = left.size();
    i %= n;
    const std::uint32_t a = left[(i + n - 1) % n], b = left[i], c = left[(i + 1) % n];
    bool ear = turn(a, b, c) > 0;
    for (std::size_t k = 0; ear && k < n && patience > 0; ++k, --patience) {
      const std::uint32_t p = left[k];
      if (p == a || p == b || p == c) continue;
      ear = !(turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0);
    }
    if (ear && patience > 0) {
      triangles.push_back({a, b, c});
      left.erase(left.begin() + std::ptrdiff_t(i));
      tried = 0;
    } else {
      ++i;
      ++tried;
      patience -= patience > 0;
    }
  }
  for (std::size_t i = 1; i + 1 < left.size(); ++i) {
    if (patience == 0 && turn(left[0], left[i], left[i + 1]) < 0) return false;
    triangles.push_back({left[0], left[i], left[i + 1]});
  }
  return true;
}

/// How many corners a search for ears may look at in all faces of a file: about ten seconds.
inline constexpr std::size_t usual_patience = 2'000'000'000;

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
    else if (face.size() > 3 && !clip_ears(made.vertices, face, made.triangles, patience))
      refuse(file, "has a face of " + std::to_string(face.size()) +
                       " corners that is too intricate to be cut into triangles here");
    begin = end;
  }
  return made;
}

}  // namespace clearance::io
