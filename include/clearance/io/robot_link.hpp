// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/mesh.hpp>
#include <clearance/io/package.hpp>
#include <clearance/io/tessellate.hpp>
#include <clearance/io/urdf.hpp>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace clearance::io {

enum class robot_geometry { collision, visual };

struct robot_options {
  robot_geometry geometry = robot_geometry::collision;      // a link without this kind uses the other, with a note
  std::map<std::string, std::filesystem::path> packages{};  // the folder of package://name
  std::vector<std::string> exclude_links{};
  double tessellation = 1e-4;                   // metres: the error of meshes for round shapes,
  std::uint32_t shape_triangles = 8000;         // unless a shape would need more triangles than this,
  std::uint32_t all_shape_triangles = 400'000;  // or more than its share of these
  bool strict = false;                          // refuse what would be noted
  mesh_limits limits{};                         // for the description and all its meshes together
};

/// One link that has geometry: all its meshes and shapes as one mesh in the link's frame, in the file's order.
struct robot_part {
  std::string name;
  triangle_mesh mesh;
  double tessellation_error = 0;  // the link's shapes reach at most this far beyond the mesh, metres; 0 for meshes
  robot_geometry used = robot_geometry::collision;
  std::size_t link = 0;  // its number in the kinematic tree
};

/// Reads the links of one robot, which share its limits.
class robot_reader {
 public:
  /// `round`: how many spheres, cylinders and capsules will be added.
  robot_reader(const std::filesystem::path& urdf, const robot_options& options, std::size_t round)
      : urdf_(urdf),
        file_(urdf.string()),
        options_(options),
        left_(options.limits),
        each_(std::uint32_t(std::min<std::size_t>(options.shape_triangles,
                                                  options.all_shape_triangles / std::max<std::size_t>(round, 1)))) {}

  /// Adds one visual or collision to a part.
  void add(robot_part& part, const urdf_shape& shape) {
    const std::string owner = "link " + io::quoted(part.name) + ": ";
    tessellation added;
    try {
      added = std::visit([&](const auto& geometry) { return make(geometry); }, shape.geometry);
    } catch (const std::runtime_error& error) {
      std::string why = error.what();
      if (const std::string named = sentence(file_, 200) + ": "; why.starts_with(named)) why.erase(0, named.size());
      refuse(file_, owner + why, shape.line);
    }
    const std::uint64_t triangles = added.mesh.triangles.size();
    if (triangles > left_.triangles)
      refuse(file_,
             owner + "with it the robot has more than " + std::to_string(options_.limits.triangles) +
                 " triangles (mesh_limits::triangles)",
             shape.line);
    left_.triangles -= triangles;
    const auto first = std::uint32_t(part.mesh.vertices.size());
    if (part.mesh.vertices.size() + added.mesh.vertices.size() > UINT32_MAX)
      refuse(file_, owner + "it has more vertices than can be counted", shape.line);
    for (const auto& v : added.mesh.vertices) {
      part.mesh.vertices.push_back(shape.origin * v);
      if (!part.mesh.vertices.back().allFinite())
        refuse(file_, owner + "its origin or scale puts a vertex beyond what a number can hold", shape.line);
    }
    part.mesh.shapes.push_back(std::uint32_t(part.mesh.triangles.size()));
    for (const auto& t : added.mesh.triangles)
      part.mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    part.tessellation_error = std::max(part.tessellation_error, added.error);
  }

 private:
  /// Half the thickness given to a flat shape, metres. It becomes a solid, and the growth is added to its error.
  static constexpr double least = 1e-6;

  static tessellation thick(tessellation made, std::ptrdiff_t ways) {
    made.error += least * std::sqrt(double(ways));
    return made;
  }

  tessellation make(const urdf_box& box) const {
    Eigen::Vector3d size = box.size;
    for (double& side : size)
      if (side == 0) side = 2 * least;
    return thick(tessellate_box(size), (box.size.array() == 0).count());
  }
  tessellation make(const urdf_sphere& s) const {
    return thick(tessellate_sphere(s.radius > 0 ? s.radius : least, options_.tessellation, each_), s.radius == 0);
  }
  tessellation make(const urdf_cylinder& c) const {
    return thick(tessellate_cylinder(c.radius > 0 ? c.radius : least, c.length > 0 ? c.length : 2 * least,
                                     options_.tessellation, each_),
                 (c.radius == 0) + (c.length == 0));
  }
  tessellation make(const urdf_capsule& c) const {
    const double radius = c.radius > 0 ? c.radius : least;
    return thick(c.length > 0 ? tessellate_capsule(radius, c.length, options_.tessellation, each_)
                              : tessellate_sphere(radius, options_.tessellation, each_),
                 c.radius == 0);
  }
  tessellation make(const urdf_mesh& mesh) {
    const auto file = resolve_uri(mesh.uri, urdf_, options_.packages);
    tessellation made{load_mesh(file, left_), 0};
    left_.bytes -= std::min(left_.bytes, std::uint64_t(std::filesystem::file_size(file)));
    for (auto& v : made.mesh.vertices) v = v.cwiseProduct(mesh.scale);
    if ((mesh.scale.array() < 0).count() % 2)  // mirrored: turn the triangles, so that they still face out
      for (auto& t : made.mesh.triangles) std::swap(t[1], t[2]);
    return made;
  }

  const std::filesystem::path& urdf_;
  const std::string file_;
  const robot_options& options_;
  mesh_limits left_;
  std::uint32_t each_;  // triangles per round shape
};

}  // namespace clearance::io
