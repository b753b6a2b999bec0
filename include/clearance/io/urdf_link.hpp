// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/xml.hpp>

#include <Eigen/Geometry>

#include <string>
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

/// A name that can be shown: at most 100 bytes, without control characters.
inline std::string urdf_name(const xml_place& at, std::string_view attribute = "name") {
  const std::string& name = at.attribute(attribute);
  if (name.empty()) at.refuse("has an empty " + std::string(attribute));
  if (name.size() > 100) at.refuse("has a name of more than 100 bytes: " + io::quoted(name));
  for (std::size_t i = 0; i < name.size(); ++i)
    if (const auto c = std::uint8_t(name[i]);
        c < ' ' || c == 0x7f || (c == 0xc2 && i + 1 < name.size() && std::uint8_t(name[i + 1]) < 0xa0))
      at.refuse("has control characters in its name");
  return name;
}

/// The pose in <origin>: fixed axes, roll about x first, then pitch about y, then yaw about z.
inline Eigen::Isometry3d urdf_origin(const xml_place& around) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const xml_element* element = around.child("origin");
  if (!element) return pose;
  const xml_place origin = around.in(*element);
  if (element->attribute("xyz")) {
    const auto xyz = origin.numbers<3>("xyz");
    pose.translation() << xyz[0], xyz[1], xyz[2];
  }
  if (element->attribute("rpy")) {
    const auto rpy = origin.numbers<3>("rpy");
    pose.linear() =
        (Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
  }
  return pose;
}

inline urdf_geometry read_urdf_geometry(const xml_place& around) {
  const xml_element* only = nullptr;
  std::size_t count = 0;
  for (const auto& child : around.element.children)
    for (const char* known : {"box", "sphere", "cylinder", "capsule", "mesh"})
      if (child.name == known) only = &child, ++count;
  if (count == 0 && around.element.children.size() == 1)
    around.in(around.element.children.front()).refuse("is no shape of URDF");
  if (count != 1) around.refuse("has " + std::to_string(count) + " shapes, not one");
  const xml_place shape = around.in(*only);
  const std::string& kind = shape.element.name;
  const auto length = [&](double value, const char* what) {
    if (!(value >= 0)) shape.refuse("has a " + std::string(what) + " below 0");
    return value;
  };
  if (kind == "box") {
    const auto size = shape.numbers<3>("size");
    return urdf_box{{length(size[0], "side"), length(size[1], "side"), length(size[2], "side")}};
  }
  if (kind == "sphere") {
    return urdf_sphere{length(shape.numbers<1>("radius")[0], "radius")};
  }
  if (kind == "cylinder" || kind == "capsule") {
    const double radius = length(shape.numbers<1>("radius")[0], "radius");
    const double along = length(shape.numbers<1>("length")[0], "length");
    if (kind == "cylinder") return urdf_cylinder{radius, along};
    return urdf_capsule{radius, along};
  }
  urdf_mesh mesh{shape.attribute("filename"), {1, 1, 1}};
  if (mesh.uri.empty() || mesh.uri.find('\0') != mesh.uri.npos) shape.refuse("has an empty file name");
  if (shape.element.attribute("scale")) {
    const auto scale = shape.numbers<3>("scale");
    mesh.scale << scale[0], scale[1], scale[2];
  }
  if ((mesh.scale.array() == 0).any()) shape.refuse("has a scale of 0");
  return mesh;
}

inline urdf_link read_urdf_link(const xml_place& at) {
  urdf_link made{urdf_name(at), {}, {}};
  const std::string owner = "link " + io::quoted(made.name);
  const xml_place link{at.element, at.file, owner};
  for (const auto& child : link.element.children) {
    if (child.name != "visual" && child.name != "collision") continue;
    const xml_place shape = link.in(child);
    const xml_element* geometry = shape.child("geometry");
    if (!geometry) shape.refuse("has no geometry");
    (child.name == "visual" ? made.visual : made.collision)
        .push_back({read_urdf_geometry(shape.in(*geometry)), urdf_origin(shape), geometry->line});
  }
  return made;
}

}  // namespace clearance::io
