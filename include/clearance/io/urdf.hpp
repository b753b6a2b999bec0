// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A URDF reader that takes every number or refuses the file. urdfdom instead logs what it cannot read, returns the link
// without it, and sorts links and joints by name.

#include <clearance/io/kinematics.hpp>
#include <clearance/io/urdf_link.hpp>
#include <clearance/io/urdf_words.hpp>

#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace clearance::io {

/// A file's links in its order, its joints as a tree, and notes about what was skipped.
struct urdf_file {
  std::string name;
  std::vector<urdf_link> links;
  kinematic_tree tree;
  note_tally notes;
};

inline joint read_urdf_joint(const xml_place& at, note_tally& notes) {
  joint made;
  made.name = urdf_name(at);
  const std::string owner = "joint " + io::quoted(made.name);
  const xml_place here{at.element, at.file, owner};
  const auto link = [&](const char* which) {
    const xml_element* element = here.child(which);
    if (!element) here.refuse("has no <" + std::string(which) + ">");
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
    const auto xyz = here.in(*axis).numbers<3>("xyz");
    made.axis << xyz[0], xyz[1], xyz[2];
  }
  const xml_element* limit = here.child("limit");
  if (made.kind == joint_kind::revolute || made.kind == joint_kind::prismatic) {
    if (!limit) here.refuse("has no <limit>, which a " + type + " joint needs");
    const xml_place at_limit = here.in(*limit);
    made.lower = at_limit.number_or("lower", 0);  // URDF's default
    made.upper = at_limit.number_or("upper", 0);
    if (made.lower > made.upper) {
      notes.add("has a lower limit above its upper limit, and is taken to have none", owner, limit->line);
      made.lower = -std::numeric_limits<double>::infinity(), made.upper = std::numeric_limits<double>::infinity();
    }
  }
  if (const xml_element* mimicked = here.child("mimic"); mimicked && made.kind != joint_kind::fixed) {
    const xml_place follow = here.in(*mimicked);
    made.follows = mimic{urdf_name(follow, "joint"), follow.number_or("multiplier", 1), follow.number_or("offset", 0)};
  }
  return made;
}

/// If a joint follows a joint of another file, this file does not say where it is, so it takes a value of its own. A
/// name that nearly matches a joint here is a misspelling, and refused.
inline void free_followers(std::vector<joint>& joints, const std::vector<const xml_element*>& at,
                           const std::string& file, note_tally& notes) {
  constexpr std::size_t most = 1000;  // because each is compared with every joint
  std::set<std::string_view> names;
  for (const joint& each : joints) names.insert(each.name);
  for (std::size_t i = 0, freed = 0; i < joints.size(); ++i) {
    if (!joints[i].follows) continue;
    const std::string& leader = joints[i].follows->joint;
    if (names.contains(leader)) continue;
    if (++freed > most)
      refuse(file, "more than " + std::to_string(most) + " joints follow joints that are not in this file",
             at[i]->line);
    const std::string who = "joint " + io::quoted(joints[i].name);
    for (const joint& other : joints)
      if (&other != &joints[i] && one_letter_off(other.name, leader))
        refuse(
            file,
            who + ": follows " + io::quoted(leader) + ", which is not in this file (" + io::quoted(other.name) + "?)",
            at[i]->line);
    joints[i].follows.reset();
    notes.add("follows a joint that is not in this file, and takes a value of its own", who, at[i]->line);
  }
}

/// Where the XML declaration begins, if blanks precede it; else 0. XML allows none, but people leave empty lines.
inline std::size_t declaration_after_blanks(std::string_view text) {
  const std::size_t mark = text.size() - without_mark(text).size(), begin = text.find_first_not_of(" \t\r\n", mark);
  return begin != text.npos && begin > mark && text.substr(begin).starts_with("<?xml ") ? begin : 0;
}

/// Reads a URDF file; links and joints keep its order. Throws std::runtime_error with the file's name, the line, and
/// the link or joint, if something that decides where geometry is cannot be read, is missing or is unknown. `strict`
/// refuses what would be noted.
inline urdf_file read_urdf(const std::string& file, const mesh_limits& limits = {}, bool strict = false) {
  const std::string text = read_bytes(file, {.piped = limits.bytes});
  if (text.size() > limits.bytes)
    refuse(file, "is longer than the limit of " + std::to_string(limits.bytes) + " bytes (mesh_limits::bytes)");
  const std::size_t begin = declaration_after_blanks(text);
  const xml_element root = read_xml(std::string_view(text).substr(begin), file, limits, xml_prefixes::any);
  if (root.name != "robot") refuse(file, "is not a URDF file: it has no element robot", root.line);
  urdf_file made;
  made.notes = note_tally(file, strict);
  if (begin > 0) made.notes.add("stand before the XML declaration, and are passed over", "blanks", 1);
  urdf_judge(file, made.notes).judge(root);
  const xml_place robot{root, file, ""};
  if (root.attribute("name"))
    made.name = urdf_name(robot);
  else
    made.notes.add("has no name", "<robot>", root.line);
  std::vector<std::string> names;
  std::vector<joint> joints;
  std::vector<const xml_element*> joints_at;
  for (const auto& child : root.children) {
    if (child.name == "link") {
      made.links.push_back(read_urdf_link(robot.in(child)));
      names.push_back(made.links.back().name);
    } else if (child.name == "joint") {
      joints.push_back(read_urdf_joint(robot.in(child), made.notes));
      joints_at.push_back(&child);
    }
  }
  if (names.empty()) refuse(file, "is no valid URDF: it has no link");
  free_followers(joints, joints_at, file, made.notes);
  try {
    made.tree = kinematic_tree(std::move(names), std::move(joints));
  } catch (const std::invalid_argument& error) {
    refuse(file, error.what());
  }
  return made;
}

}  // namespace clearance::io
