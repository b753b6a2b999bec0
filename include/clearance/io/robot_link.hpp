// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/mesh.hpp>
#include <clearance/io/package.hpp>
#include <clearance/io/tessellate.hpp>
#include <clearance/io/urdf.hpp>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace clearance::io {

enum class robot_geometry { collision, visual };

struct robot_options {
  robot_geometry geometry = robot_geometry::collision;      // a link that has none of it gives the other, with a note
  std::map<std::string, std::filesystem::path> packages{};  // where package://name is
  std::vector<std::string> exclude_links{};
  double tessellation = 1e-4;  // metres; boxes, cylinders and spheres become meshes no farther from them
};

/// One link that has geometry: all its meshes and shapes as one mesh in the link's frame, triangles in the file's
/// order.
struct robot_part {
  std::string name;
  triangle_mesh mesh;
  double tessellation_error = 0;  // the link's shapes reach at most so far beyond the mesh, metres; 0 if all are meshes
  robot_geometry used = robot_geometry::collision;
  std::size_t link = 0;  // its number in the kinematic tree
};

/// One shape or mesh of a link, before its origin is applied.
inline tessellation load_geometry(const urdf::Geometry& geometry, const std::string& link,
                                  const std::filesystem::path& urdf, const robot_options& options) {
  const auto length = [&](double value, const char* what) {
    if (!(value > 0) || !std::isfinite(value))
      refuse(urdf.string(), "link \"" + link + "\" has a " + what + " of " + std::to_string(value) + " m");
    return value;
  };
  if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry))
    return tessellate_box(
        {length(box->dim.x, "box side"), length(box->dim.y, "box side"), length(box->dim.z, "box side")});
  if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry))
    return tessellate_sphere(length(sphere->radius, "sphere radius"), options.tessellation);
  if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry))
    return tessellate_cylinder(length(cylinder->radius, "cylinder radius"), length(cylinder->length, "cylinder length"),
                               options.tessellation);
  const auto* mesh = dynamic_cast<const urdf::Mesh*>(&geometry);
  if (!mesh) refuse(urdf.string(), "link \"" + link + "\" has a geometry of a kind that is not supported");
  tessellation made{load_mesh(resolve_uri(mesh->filename, urdf, options.packages)), 0};
  const Eigen::Vector3d scale(mesh->scale.x, mesh->scale.y, mesh->scale.z);
  if (!scale.allFinite() || scale.prod() == 0)
    refuse(urdf.string(), "link \"" + link + "\" has a mesh scale that is 0 or not finite");
  for (auto& v : made.mesh.vertices) v = v.cwiseProduct(scale);
  if (scale.prod() < 0)  // a mirror image: turn the triangles, so that they face out again
    for (auto& t : made.mesh.triangles) std::swap(t[1], t[2]);
  return made;
}

/// Adds one visual or collision to a part.
template <class Shape>
void add_geometry(robot_part& part, const Shape& shape, const std::filesystem::path& urdf,
                  const robot_options& options) {
  Eigen::Isometry3d origin;
  if (!rigid_pose(shape.origin, origin))
    refuse(urdf.string(), "link \"" + part.name + "\" has an origin that is not finite");
  if (!shape.geometry) refuse(urdf.string(), "link \"" + part.name + "\" has a visual or collision without geometry");
  const tessellation added = load_geometry(*shape.geometry, part.name, urdf, options);
  const auto first = std::uint32_t(part.mesh.vertices.size());
  if (part.mesh.vertices.size() + added.mesh.vertices.size() > UINT32_MAX)
    refuse(urdf.string(), "link \"" + part.name + "\" has more vertices than can be counted");
  for (const auto& v : added.mesh.vertices) part.mesh.vertices.push_back(origin * v);
  for (const auto& t : added.mesh.triangles) part.mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  part.tessellation_error = std::max(part.tessellation_error, added.error);
}

}  // namespace clearance::io
