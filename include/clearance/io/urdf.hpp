// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A reader of URDF that takes every number or refuses the file: urdfdom logs what it cannot read, returns the link
// without it, and sorts links and joints by name.

#include <clearance/io/kinematics.hpp>
#include <clearance/io/urdf_link.hpp>

#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace clearance::io {

/// The links of a file, in its order, and its joints as a tree.
struct urdf_file {
  std::string name;
  std::vector<urdf_link> links;
  kinematic_tree tree;
};

inline joint read_urdf_joint(const xml_place& at) {
  joint made;
  made.name = urdf_name(at);
  const std::string owner = "joint " + io::quoted(made.name);
  const xml_place here{at.element, at.file, owner};
  here.only({"name", "type"}, {"origin", "parent", "child", "axis", "limit", "mimic", "dynamics", "calibration",
                               "safety_controller", "disable_collision"});
  const auto link = [&](const char* which) {
    const xml_element* element = here.child(which);
    if (!element) here.refuse("has no <" + std::string(which) + ">");
    here.in(*element).only({"link"}, {});
    return urdf_name(here.in(*element), "link");
  };
  made.parent = link("parent");
  made.child = link("child");
  made.origin = urdf_origin(here);
  const std::string& type = here.attribute("type");
  if (type == "floating") here.refuse("is floating, which is not supported: give the base pose instead");
  if (type == "planar") here.refuse("is planar, which is not supported");
  if (type == "continuous")
    made.kind = joint_kind::continuous;
  else if (type == "revolute")
    made.kind = joint_kind::revolute;
  else if (type == "prismatic")
    made.kind = joint_kind::prismatic;
  else if (type != "fixed")
    here.refuse("has the unknown type " + io::quoted(type));
  if (const xml_element* axis = here.child("axis"); axis && made.kind != joint_kind::fixed) {
    here.in(*axis).only({"xyz"}, {});
    const auto xyz = here.in(*axis).numbers<3>("xyz");
    made.axis << xyz[0], xyz[1], xyz[2];
  }
  const xml_element* limit = here.child("limit");
  if (made.kind == joint_kind::revolute || made.kind == joint_kind::prismatic) {
    if (!limit) here.refuse("has no <limit>, which a " + type + " joint needs");
    const xml_place at_limit = here.in(*limit);
    at_limit.only({"lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"}, {});
    made.lower = at_limit.number_or("lower", 0);  // what URDF says of one that is left out
    made.upper = at_limit.number_or("upper", 0);
  }
  if (const xml_element* mimicked = here.child("mimic"); mimicked && made.kind != joint_kind::fixed) {
    const xml_place follow = here.in(*mimicked);
    follow.only({"joint", "multiplier", "offset"}, {});
    made.follows = mimic{urdf_name(follow, "joint"), follow.number_or("multiplier", 1), follow.number_or("offset", 0)};
  }
  return made;
}

/// Whether a link, a joint or a shape is hidden somewhere in an element.
inline bool holds_urdf(const xml_element& element) {
  for (const char* word : {"link", "joint", "visual", "collision", "geometry", "parent", "child"})
    if (element.name == word) return true;
  return std::ranges::any_of(element.children, holds_urdf);
}

/// How many elements of a shape are anywhere in an element, other vocabularies apart.
inline std::size_t shape_elements(const xml_element& element) {
  if (element.name.find(':') != element.name.npos) return 0;
  std::size_t count = element.name == "visual" || element.name == "collision" || element.name == "geometry";
  for (const auto& child : element.children) count += shape_elements(child);
  return count;
}

/// What was read is counted against what is there: a shape inside another element would be lost without a word.
inline void check_shapes(const xml_place& at, std::size_t read) {
  if (const std::size_t there = shape_elements(at.element); there != 2 * read)  // each has its geometry
    at.refuse("has " + std::to_string(there) + " elements <visual>, <collision> and <geometry> in it, but " +
              std::to_string(2 * read) + " where they belong");
}

inline void refuse_xacro(const xml_element& element, const std::string& file) {
  if (element.name.starts_with("xacro:")) refuse(file, "has xacro in it: expand it with xacro first", element.line);
  for (const auto& child : element.children) refuse_xacro(child, file);
}

/// Reads a URDF file; links and joints keep its order. Throws std::runtime_error with the file's name, the line, and
/// the link or joint, if anything in it that says where geometry is cannot be read, is missing or is not known.
inline urdf_file read_urdf(const std::string& file, const mesh_limits& limits = {}) {
  const std::string text = read_bytes(file, {.piped = limits.bytes});
  if (text.size() > limits.bytes)
    refuse(file, "is longer than the limit of " + std::to_string(limits.bytes) + " bytes (mesh_limits::bytes)");
  const xml_element root = read_xml(text, file, limits);
  if (root.name != "robot") refuse(file, "is not a URDF file: it has no element robot", root.line);
  refuse_xacro(root, file);
  const xml_place robot{root, file, ""};
  robot.no_text();
  urdf_file made;
  made.name = urdf_name(robot);
  std::vector<std::string> names;
  std::vector<joint> joints;
  for (const auto& child : root.children) {
    const xml_place at = robot.in(child);
    if (child.name == "link") {
      made.links.push_back(read_urdf_link(at));
      check_shapes({child, file, "link " + io::quoted(made.links.back().name)},
                   made.links.back().visual.size() + made.links.back().collision.size());
      names.push_back(made.links.back().name);
    } else if (child.name == "joint") {
      joints.push_back(read_urdf_joint(at));
      check_shapes({child, file, "joint " + io::quoted(joints.back().name)}, 0);
    } else if (child.name == "transmission" || child.name == "sensor" || child.name == "ros2_control") {
      check_shapes(at, 0);
    } else if (child.name != "gazebo" && child.name.find(':') == child.name.npos && holds_urdf(child)) {
      at.refuse("is not known, and has a part of a robot in it");
    }
  }
  if (names.empty()) refuse(file, "is no valid URDF: it has no link");
  try {
    made.tree = kinematic_tree(std::move(names), std::move(joints));
  } catch (const std::invalid_argument& error) {
    refuse(file, error.what());
  }
  return made;
}

}  // namespace clearance::io
