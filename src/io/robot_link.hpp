// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The geometry of a robot's links, one mesh for each. Boxes, balls, cylinders and capsules become triangles.

#include "io/package.hpp"
#include "io/urdf.hpp"

#include <clearance/io/mesh.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/solid/triangle_mesh.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace clearance::io {

/// A closed mesh that faces out. It is inscribed: its vertices are on the shape's surface, which is at most `error`
/// metres beyond the mesh, and nowhere inside it.
struct tessellation {
  triangle_mesh mesh;
  double error = 0;
};

/// How far a ball around the origin reaches beyond a triangle's plane.
inline double beyond(const triangle_mesh& mesh, const std::array<std::uint32_t, 3>& t, double radius) {
  const Eigen::Vector3d& p = mesh.vertices[t[0]];
  return radius - (mesh.vertices[t[1]] - p).cross(mesh.vertices[t[2]] - p).normalized().dot(p);
}

/// Twelve triangles, exact.
inline tessellation tessellate_box(const Eigen::Vector3d& size) {
  tessellation made;
  for (int i = 0; i < 8; ++i)
    made.mesh.vertices.push_back(0.5 *
                                 size.cwiseProduct(Eigen::Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  made.mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                         {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return made;
}

/// The default limit of triangles for one shape. A sphere of 14 cm needs this many for an error of 0.1 mm; one of 1 m
/// is then off by 0.73 mm.
inline constexpr std::uint32_t most_triangles = 8000;

/// A cylinder along z with its middle at the origin. It gets enough sides to keep the error below `tolerance`, but at
/// least 12, and at most `triangles` triangles.
inline tessellation tessellate_cylinder(double radius, double length, double tolerance = 1e-4,
                                        std::uint32_t triangles = most_triangles) {
  using std::numbers::pi;
  const double half_angle = std::acos(std::clamp(1 - tolerance / radius, -1.0, 1.0));
  const auto n = std::uint32_t(
      std::clamp(std::ceil(pi / std::max(half_angle, 1e-9)), 12.0, std::max(12.0, std::floor(triangles / 4.0))));
  tessellation made;
  made.error = radius * (1 - std::cos(pi / n)) + 1e-15 * (radius + length);  // 1e-15: rounding
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

/// A sphere around the origin: an icosahedron, its faces split evenly until the error is below `tolerance`, but into at
/// least 80 and at most `triangles` triangles.
inline tessellation tessellate_sphere(double radius, double tolerance = 1e-4,
                                      std::uint32_t triangles = most_triangles) {
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

  // Triangles are largest in the middle of a face; there the error is 0.292 radius / n^2.
  const double most = std::max(2.0, std::floor(std::sqrt(triangles / 20.0)));
  const auto n = std::uint32_t(std::clamp(std::ceil(std::sqrt(0.292 * radius / tolerance)), 2.0, most));

  tessellation made;
  // Faces share the vertices on their edges, so a vertex is identified by its corners and their weights.
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

  for (const auto& t : made.mesh.triangles) made.error = std::max(made.error, beyond(made.mesh, t, radius));
  made.error += 1e-15 * radius;
  return made;
}

/// A capsule along z with its middle at the origin: a cylinder of this length with half a ball on either end. It gets
/// enough triangles to keep the error below `tolerance`, but at least 64 and at most `triangles`.
inline tessellation tessellate_capsule(double radius, double length, double tolerance = 1e-4,
                                       std::uint32_t triangles = most_triangles) {
  using std::numbers::pi;
  // Patches are pi / 2 / rings wide either way; in the middle of one the error is (pi / 4 / rings)^2 radius.
  const double most = std::max(2.0, std::floor(std::sqrt(triangles / 16.0)));
  const auto rings = std::uint32_t(std::clamp(std::ceil(pi / 4 * std::sqrt(radius / tolerance)), 2.0, most));
  const std::uint32_t n = 4 * rings;  // sides: 4 n rings triangles

  tessellation made;
  made.mesh.vertices = {{0, 0, 0.5 * length + radius}, {0, 0, -0.5 * length - radius}};
  for (std::uint32_t k = 1; k <= 2 * rings; ++k) {  // from the upper pole down; the equator is there twice
    const double up = k <= rings ? 0.5 : -0.5, at = pi / 2 * (k <= rings ? k : k - 1) / rings;
    for (std::uint32_t i = 0; i < n; ++i)
      made.mesh.vertices.emplace_back(radius * std::sin(at) * std::cos(2 * pi * i / n),
                                      radius * std::sin(at) * std::sin(2 * pi * i / n),
                                      up * length + radius * std::cos(at));
  }

  const auto vertex = [&](std::uint32_t k, std::uint32_t i) { return 2 + (k - 1) * n + i % n; };
  for (std::uint32_t i = 0; i < n; ++i) {
    made.mesh.triangles.push_back({0, vertex(1, i), vertex(1, i + 1)});
    for (std::uint32_t k = 1; k < 2 * rings; ++k) {
      made.mesh.triangles.push_back({vertex(k, i), vertex(k + 1, i), vertex(k + 1, i + 1)});
      made.mesh.triangles.push_back({vertex(k, i), vertex(k + 1, i + 1), vertex(k, i + 1)});
    }
    made.mesh.triangles.push_back({1, vertex(2 * rings, i + 1), vertex(2 * rings, i)});
  }

  triangle_mesh ball = made.mesh;  // without the cylinder; the corners of a ring bound the error of its sides
  for (std::uint32_t v = 0; v < ball.vertices.size(); ++v)
    ball.vertices[v].z() += (v == 0 || (v > 1 && v < 2 + rings * n) ? -0.5 : 0.5) * length;
  const auto upper = [&](std::uint32_t v) { return v >= 2 && v < 2 + rings * n; };
  for (const auto& t : made.mesh.triangles) {
    const bool side = t[0] > 1 && (upper(t[0]) != upper(t[1]) || upper(t[1]) != upper(t[2]));
    if (!side) made.error = std::max(made.error, beyond(ball, t, radius));
  }
  made.error = std::max(made.error, radius * (1 - std::cos(pi / n))) + 1e-15 * (radius + length);
  return made;
}

/// Reads the links of one robot, which share its limits.
class robot_reader {
 public:
  /// `round`: how many spheres, cylinders and capsules will be added.
  robot_reader(const std::filesystem::path& urdf, const robot_options& options, std::size_t round, note_tally& notes)
      : file_(urdf.string()),
        options_(options),
        notes_(notes),
        lookup_(urdf, options.packages),
        left_(options.limits),
        each_(std::uint32_t(std::min<std::size_t>(options.shape_triangles,
                                                  options.all_shape_triangles / std::max<std::size_t>(round, 1)))) {
    if (!(options.tessellation >= 0))
      throw std::invalid_argument("clearance: robot_options::tessellation is " + std::to_string(options.tessellation) +
                                  " m, which must be 0 or more");
  }

  /// The packages that were given and that no mesh was in.
  std::vector<std::string> unused_packages() const { return lookup_.unused(); }

  /// Adds one visual or collision to a part; `up` is for a glTF mesh, which gets a note without it.
  void add(robot_part& part, const urdf_shape& shape, std::optional<gltf_axis> up) {
    const std::string owner = "link " + io::quoted(part.name) + ": ";
    tessellation added;
    try {
      if (const auto* mesh = std::get_if<urdf_mesh>(&shape.geometry))
        added = make(*mesh, up, "link " + io::quoted(part.name), shape.line);
      else
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
  tessellation make(const urdf_mesh&) const { return {}; }  // the other one
  tessellation make(const urdf_mesh& mesh, std::optional<gltf_axis> up, const std::string& who, std::size_t line) {
    const auto [file, how] = lookup_(mesh.uri);
    if (!how.empty()) notes_.add(how, who, line);
    loaded_mesh read = load_mesh_noted(file, left_, up);
    left_.bytes -= std::min(left_.bytes, read.bytes);
    for (const std::string& note : read.notes) notes_.add("has a mesh whose file " + note, who, line);
    tessellation made{std::move(read.mesh), 0};
    for (auto& v : made.mesh.vertices) v = v.cwiseProduct(mesh.scale);
    if ((mesh.scale.array() < 0).count() % 2)  // mirrored: turn the triangles, so that they still face out
      for (auto& t : made.mesh.triangles) std::swap(t[1], t[2]);
    return made;
  }

  const std::string file_;
  const robot_options& options_;
  note_tally& notes_;
  mesh_lookup lookup_;
  mesh_limits left_;
  std::uint32_t each_;  // triangles per round shape
};

}  // namespace clearance::io
