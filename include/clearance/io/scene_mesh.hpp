// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Shapes of a scene, in glTF's terms.

#include <clearance/ground/math.hpp>
#include <clearance/io/sentence.hpp>
#include <clearance/solid/triangle_mesh.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace clearance::io {

/// 0 to 1 each.
struct colour {
  float red, green, blue, alpha;
};

/// A name as glTF may hold it: valid UTF-8, and not too long for a viewer.
inline std::string scene_name(const std::string& name) { return shortened(printable(name), 1000); }

/// Triangles with a normal at each vertex, or points.
struct drawn_mesh {
  std::vector<vec3> positions, normals;
  std::vector<std::uint32_t> corners;  // three per triangle; empty: these are points
  std::vector<colour> colours = {};    // one per point, or empty
};

inline vec3 to_vec3(const Eigen::Vector3d& v) { return {float(v.x()), float(v.y()), float(v.z())}; }

/// Flat shading: each triangle has its own three vertices.
inline drawn_mesh faces_of(const triangle_mesh& mesh) {
  drawn_mesh out;
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t k) -> const Eigen::Vector3d& { return mesh.vertices[t[k]]; };
    Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    normal = normal.norm() > 0 ? Eigen::Vector3d(normal / normal.norm()) : Eigen::Vector3d::UnitZ();
    for (std::size_t k = 0; k < 3; ++k) {
      out.corners.push_back(std::uint32_t(out.positions.size()));
      out.positions.push_back(to_vec3(corner(k)));
      out.normals.push_back(to_vec3(normal));
    }
  }
  return out;
}

/// The finite points; `colours`: one per point, or empty.
inline drawn_mesh points_of(const std::vector<vec3>& points, const std::vector<colour>& colours = {}) {
  drawn_mesh out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_finite(points[i])) continue;
    out.positions.push_back(points[i]);
    if (!colours.empty()) out.colours.push_back(colours.at(i));
  }
  return out;
}

/// A square rod along `v`, because lines of one pixel are overlooked. Its width is 1 % of its length, but 1 to 10 mm.
inline triangle_mesh rod(const Eigen::Vector3d& v) {
  const double thick = std::min(0.01, std::max(0.001, 0.01 * v.norm())) / 2;
  const Eigen::Vector3d along = v.norm() > 0 ? Eigen::Vector3d(v.normalized()) : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d a = along.unitOrthogonal() * thick, b = along.cross(a);
  const Eigen::Vector3d end = v.norm() > thick ? v : Eigen::Vector3d(along * thick);
  triangle_mesh mesh;
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(Eigen::Vector3d::Zero()), end})
    for (const Eigen::Vector3d& corner :
         {Eigen::Vector3d(a + b), Eigen::Vector3d(b - a), Eigen::Vector3d(-a - b), Eigen::Vector3d(a - b)})
      mesh.vertices.push_back(at + corner);
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}};
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t n = (k + 1) % 4;
    mesh.triangles.push_back({k, n, n + 4});
    mesh.triangles.push_back({k, n + 4, k + 4});
  }
  return mesh;
}

}  // namespace clearance::io
