// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A URDF reader that takes every number or refuses the file. urdfdom instead logs what it cannot read, returns the link
// without it, and sorts links and joints by name.

#include "io/note_tally.hpp"

#include <clearance/io/kinematics.hpp>
#include <clearance/io/limits.hpp>

#include <Eigen/Geometry>

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace clearance::io {

struct urdf_box {
  Eigen::Vector3d size;
};

struct urdf_sphere {
  double radius;
};

struct urdf_cylinder {
  double radius, length;
};

/// A cylinder along z with half a ball on either end; `length` does not include them.
struct urdf_capsule {
  double radius, length;
};

struct urdf_mesh {
  std::string uri;
  Eigen::Vector3d scale;
};

using urdf_geometry = std::variant<urdf_box, urdf_sphere, urdf_cylinder, urdf_capsule, urdf_mesh>;

/// One visual or collision of a link.
struct urdf_shape {
  urdf_geometry geometry;
  Eigen::Isometry3d origin;  // link-from-shape
  std::size_t line;          // where its geometry is in the file

  /// Is it a point, a segment or a plate? Then a side, radius or length is 0.
  bool flat() const {
    if (const auto* box = std::get_if<urdf_box>(&geometry)) return (box->size.array() == 0).any();
    if (const auto* sphere = std::get_if<urdf_sphere>(&geometry)) return sphere->radius == 0;
    if (const auto* cylinder = std::get_if<urdf_cylinder>(&geometry))
      return cylinder->radius == 0 || cylinder->length == 0;
    const auto* capsule = std::get_if<urdf_capsule>(&geometry);
    return capsule && capsule->radius == 0;
  }
  /// Does it become triangles that only approximate it?
  bool round() const {
    return !std::holds_alternative<urdf_box>(geometry) && !std::holds_alternative<urdf_mesh>(geometry);
  }
};

struct urdf_link {
  std::string name;
  std::vector<urdf_shape> collision, visual;
};

/// A file's links in its order, its joints as a tree, and notes about what was skipped.
struct urdf_file {
  std::string name;
  std::vector<urdf_link> links;
  kinematic_tree tree;
  note_tally notes;
};

/// Where the XML declaration begins, if blanks precede it; else 0. XML allows none, but people leave empty lines.
std::size_t declaration_after_blanks(std::string_view text);

/// Reads a URDF file; links and joints keep its order. Throws std::runtime_error with the file's name, the line, and
/// the link or joint, if something that decides where geometry is cannot be read, is missing or is unknown. `strict`
/// refuses what would be noted.
urdf_file read_urdf(const std::string& file, const mesh_limits& limits = {}, bool strict = false);
/// The same of the text itself; `file` is what errors call it.
urdf_file read_urdf_text(std::string_view text, const std::string& file, const mesh_limits& limits = {},
                         bool strict = false);

}  // namespace clearance::io
