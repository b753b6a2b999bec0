// SPDX-License-Identifier: BSD-3-Clause
#include "io/urdf.hpp"

#include "io/near_word.hpp"
#include "io/note_tally.hpp"
#include "io/urdf_words.hpp"
#include "io/xml.hpp"

#include <clearance/io/kinematics.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace clearance::io {

namespace {

/// A name that can be shown: at most 100 bytes, without control characters.
std::string urdf_name(const xml_place& at, std::string_view attribute = "name") {
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
Eigen::Isometry3d urdf_origin(const xml_place& around) {
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

urdf_geometry read_urdf_geometry(const xml_place& around) {
  const xml_element* only = nullptr;
  std::size_t count = 0;
  for (const auto& child : around.element.children)
    for (const char* known : {"box", "sphere", "cylinder", "capsule", "mesh"})
      if (child.name == known) {
        only = &child;
        ++count;
      }
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

urdf_link read_urdf_link(const xml_place& at) {
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

// The joints of a URDF file. Those of several degrees of freedom become the base pose, or joints of one value each.

/// A joint as a file has it.
struct urdf_joint {
  joint made;
  /// If it is not usual, `made` is fixed until it is split.
  enum class freedom { usual, planar, floating } moves = freedom::usual;
  std::size_t line = 0;

  std::string who() const { return "joint " + io::quoted(made.name); }
};

urdf_joint read_urdf_joint(const xml_place& at, note_tally& notes) {
  urdf_joint read{.made = {}, .line = at.element.line};
  joint& made = read.made;
  made.name = urdf_name(at);
  const std::string owner = read.who();
  const xml_place place{at.element, at.file, owner};

  const auto link = [&](const char* which) {
    const xml_element* element = place.child(which);
    if (!element) place.refuse("has no <" + std::string(which) + ">");
    return urdf_name(place.in(*element), "link");
  };
  made.parent = link("parent");
  made.child = link("child");
  made.origin = urdf_origin(place);

  const std::string& type = place.attribute("type");
  if (type == "floating")
    read.moves = urdf_joint::freedom::floating;
  else if (type == "planar")
    read.moves = urdf_joint::freedom::planar;
  else if (type == "continuous")
    made.kind = joint_kind::continuous;
  else if (type == "revolute")
    made.kind = joint_kind::revolute;
  else if (type == "prismatic")
    made.kind = joint_kind::prismatic;
  else if (type != "fixed")
    place.refuse("has the unknown type " + io::quoted(type));

  const bool planar = read.moves == urdf_joint::freedom::planar;
  if (const xml_element* axis = place.child("axis"); axis && (made.kind != joint_kind::fixed || planar)) {
    const auto xyz = place.in(*axis).numbers<3>("xyz");
    made.axis << xyz[0], xyz[1], xyz[2];
  }

  const xml_element* limit = place.child("limit");
  if (made.kind == joint_kind::revolute || made.kind == joint_kind::prismatic) {
    if (!limit) place.refuse("has no <limit>, which a " + type + " joint needs");
    const xml_place at_limit = place.in(*limit);
    made.lower = at_limit.number_or("lower", 0);  // URDF's default
    made.upper = at_limit.number_or("upper", 0);
    if (made.lower > made.upper) {
      notes.add("has a lower limit above its upper limit, and is taken to have none", owner, limit->line);
      made.lower = -std::numeric_limits<double>::infinity();
      made.upper = std::numeric_limits<double>::infinity();
    }
  }

  if (const xml_element* mimicked = place.child("mimic")) {
    const xml_place follow = place.in(*mimicked);
    if (read.moves != urdf_joint::freedom::usual) follow.refuse("is for joints of one value, and this one is " + type);
    if (made.kind == joint_kind::fixed)
      notes.add("is fixed, and its <mimic> is passed over", owner, mimicked->line);
    else
      made.follows =
          mimic{urdf_name(follow, "joint"), follow.number_or("multiplier", 1), follow.number_or("offset", 0)};
  }
  return read;
}

/// If a joint follows a joint of another file, this file does not say where it is, so it takes a value of its own. A
/// name that nearly matches a joint here is a misspelling, and refused.
void free_followers(std::vector<urdf_joint>& joints, const std::string& file, note_tally& notes) {
  constexpr std::size_t most = 1000;  // because each is compared with every joint
  std::map<std::string_view, const urdf_joint*> named;
  for (const urdf_joint& each : joints) named.emplace(each.made.name, &each);
  std::size_t freed = 0;
  for (urdf_joint& each : joints) {
    if (!each.made.follows) continue;
    const std::string& leader = each.made.follows->joint;
    if (const auto at = named.find(leader); at != named.end()) {
      if (at->second->moves != urdf_joint::freedom::usual)
        refuse(file, each.who() + ": follows " + io::quoted(leader) + ", which has several values", each.line);
      continue;
    }
    if (++freed > most)
      refuse(file, "more than " + std::to_string(most) + " joints follow joints that are not in this file", each.line);
    for (const urdf_joint& other : joints)
      if (&other != &each && one_letter_off(other.made.name, leader))
        refuse(file,
               each.who() + ": follows " + io::quoted(leader) + ", which is not in this file (" +
                   io::quoted(other.made.name) + "?)",
               each.line);
    each.made.follows.reset();
    notes.add("follows a joint that is not in this file, and takes a value of its own", each.who(), each.line);
  }
}

/// Simulators have a link "world" that files need not have; other links must be there.
void add_world(std::vector<std::string>& links, const std::vector<urdf_joint>& joints, const std::string& file,
               note_tally& notes) {
  std::set<std::string> known(links.begin(), links.end());
  for (const urdf_joint& each : joints)
    for (const std::string* name : {&each.made.parent, &each.made.child}) {
      if (known.contains(*name)) continue;
      if (name != &each.made.parent || *name != "world")
        refuse(file, each.who() + ": names the link " + io::quoted(*name) + ", which is not in this file", each.line);
      notes.add("is the parent of a joint and not in this file, and is taken as the base", "link \"world\"", each.line);
      known.insert(*name);
      links.push_back(*name);
    }
}

/// Is its parent a root without shapes, from which nothing else hangs?
bool carries_all(const joint& by, const std::vector<urdf_joint>& joints, const std::vector<urdf_link>& links) {
  for (const urdf_joint& each : joints)
    if (each.made.child == by.parent || (&each.made != &by && each.made.parent == by.parent)) return false;
  const auto parent = std::ranges::find(links, by.parent, &urdf_link::name);
  return parent == links.end() || (parent->collision.empty() && parent->visual.empty());
}

/// One of the joints that stand for a planar or floating one, without its links: "x", "y" and "z" shift, "roll",
/// "pitch" and "yaw" turn about x, y and z, as rpy does if yaw comes first.
joint step_of(const joint& whole, const std::string& name) {
  joint made;
  made.name = whole.name + "/" + name;
  made.kind = name.size() == 1 ? joint_kind::prismatic : joint_kind::continuous;
  made.parent = whole.parent;
  made.child = whole.child;
  made.axis = name == "x" || name == "roll"    ? Eigen::Vector3d::UnitX()
              : name == "y" || name == "pitch" ? Eigen::Vector3d::UnitY()
                                               : Eigen::Vector3d::UnitZ();
  return made;
}

/// The joints of one value that stand for all. A planar or floating joint that alone carries the robot is the base
/// pose; any other becomes a chain of joints NAME/x, ..., whose links, named so too, are added.
std::vector<joint> split_joints(const std::vector<urdf_joint>& read, const std::vector<urdf_link>& shapes,
                                std::vector<std::string>& links, const std::string& file, note_tally& notes) {
  using freedom = urdf_joint::freedom;
  std::vector<joint> made;
  for (const urdf_joint& each : read) {
    if (each.moves == freedom::usual) {
      made.push_back(each.made);
      continue;
    }
    const std::string kind = each.moves == freedom::planar ? "planar" : "floating";
    if (carries_all(each.made, read, shapes)) {
      notes.add("is " + kind + " and carries the whole robot, and is taken as the base pose (--base-pose)", each.who(),
                each.line);
      made.push_back(each.made);
      continue;
    }

    std::vector<joint> chain;
    std::string moves;  // in the order of the motions, from the parent on
    if (each.moves == freedom::floating) {
      for (const char* name : {"x", "y", "z", "yaw", "pitch", "roll"}) chain.push_back(step_of(each.made, name));
      moves = "NAME/x, NAME/y, NAME/z (m), NAME/yaw, NAME/pitch, NAME/roll (rad)";
    } else {
      const Eigen::Vector3d& normal = each.made.axis;
      int across = 0;
      if (normal.cwiseAbs().maxCoeff(&across) == 0 || (normal.array() != 0).count() != 1)
        refuse(file,
               each.who() + ": is planar, and its axis is none of x, y and z: turn its <origin> instead, so that it is",
               each.line);
      for (const char* name : {"x", "y", "z"})
        if (name[0] != "xyz"[across]) {
          chain.push_back(step_of(each.made, name));
          moves += "NAME/" + std::string(name) + ", ";
        }
      chain.push_back(step_of(each.made, "theta"));
      chain.back().axis = normal;
      moves = moves.substr(0, moves.size() - 2) + " (m), NAME/theta (rad)";
    }

    for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
      links.push_back(chain[k].name);
      chain[k].child = chain[k + 1].parent = links.back();
    }
    chain.front().origin = each.made.origin;
    made.insert(made.end(), chain.begin(), chain.end());
    notes.add("is " + kind + ", and moves by the joints " + moves + ", which are at 0 unless given", each.who(),
              each.line);
  }
  return made;
}

}  // namespace

std::size_t declaration_after_blanks(std::string_view text) {
  const std::size_t mark = text.size() - without_mark(text).size(), begin = text.find_first_not_of(" \t\r\n", mark);
  return begin != text.npos && begin > mark && text.substr(begin).starts_with("<?xml ") ? begin : 0;
}

urdf_file read_urdf(const std::string& file, const mesh_limits& limits, bool strict) {
  return read_urdf_text(read_bytes(file, {.piped = limits.bytes}), file, limits, strict);
}

urdf_file read_urdf_text(std::string_view text, const std::string& file, const mesh_limits& limits, bool strict) {
  if (text.size() > limits.bytes)
    refuse(file, "is longer than the limit of " + std::to_string(limits.bytes) + " bytes (mesh_limits::bytes)");
  const std::size_t begin = declaration_after_blanks(text);
  const xml_element root = read_xml(text.substr(begin), file, limits, xml_prefixes::any);
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
  std::vector<urdf_joint> read;
  for (const auto& child : root.children) {
    if (child.name == "link") {
      made.links.push_back(read_urdf_link(robot.in(child)));
      names.push_back(made.links.back().name);
    } else if (child.name == "joint") {
      read.push_back(read_urdf_joint(robot.in(child), made.notes));
    }
  }

  if (names.empty()) refuse(file, "is no valid URDF: it has no link");
  free_followers(read, file, made.notes);
  add_world(names, read, file, made.notes);
  std::vector<joint> joints = split_joints(read, made.links, names, file, made.notes);
  try {
    made.tree = kinematic_tree(std::move(names), std::move(joints));
  } catch (const std::invalid_argument& error) {
    refuse(file, error.what());
  }
  return made;
}

}  // namespace clearance::io
