// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The YAML files in which cuRobo's users keep a robot's spheres:
//
//   collision_spheres:
//     link_name:
//       - center: [x, y, z]
//         radius: r

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/packed_part.hpp>
#include <clearance/io/write_file.hpp>
#include <clearance/io/yaml_check.hpp>

#include <yaml-cpp/yaml.h>

#include <set>
#include <span>

namespace clearance::io {

namespace detail {

inline float yaml_number(const YAML::Node& node, const std::string& what, const std::string& file) {
  const auto line = std::size_t(std::max(0, node.Mark().line + 1));
  if (!node.IsScalar()) refuse(file, what + " is not a number", line);
  const auto value = number<float>(node.Scalar());
  if (!value) refuse(file, what + " is " + io::quoted(node.Scalar()) + ", not a number", line);
  return *value;
}

inline packed_part yaml_link(const YAML::Node& key, const YAML::Node& list, const std::string& file) {
  const std::string& name = key.Scalar();
  const auto line = [](const YAML::Node& node) { return std::size_t(std::max(0, node.Mark().line + 1)); };
  const std::string of = "of link " + io::quoted(name);
  if (!list.IsSequence() || list.size() == 0) refuse(file, "the spheres " + of + " are no list of spheres", line(key));
  std::vector<inner_sphere> spheres;
  for (const YAML::Node& each : list) {
    const std::string which = "sphere " + std::to_string(spheres.size()) + ' ' + of;
    if (!each.IsMap()) refuse(file, which + " has no center and radius", line(each));
    const YAML::Node center = each["center"], radius = each["radius"];
    if (!center || !center.IsSequence() || center.size() != 3)
      refuse(file, which + " has no center of three numbers", line(each));
    if (!radius) refuse(file, which + " has no radius", line(each));
    float n[3];
    for (std::size_t k = 0; k < 3; ++k) n[k] = yaml_number(center[k], "the center of " + which, file);
    spheres.push_back(checked_sphere({n[0], n[1], n[2]}, yaml_number(radius, "the radius of " + which, file), file,
                                     which, line(each)));
  }
  return {.name = name, .spheres = uncertified(std::move(spheres)), .solid = {}, .recipe = {}};
}

}  // namespace detail

/// Reads each link's spheres in the file's order. `collision_spheres` is at the top, or where a cuRobo robot
/// description has it (robot_cfg: kinematics:). They have no certificate. Throws std::runtime_error naming file and
/// line, also for more values than the limit: each takes about 500 bytes while the file is read.
inline std::vector<packed_part> load_spheres_yaml(const std::string& file, const mesh_limits& limits = {}) {
  const std::string bytes = read_bytes(file);
  std::vector<packed_part> parts;
  std::set<std::string> names;
  std::size_t spheres = 0;
  try {
    YAML::Node at = parse_yaml(bytes, file, limits);
    for (const char* above : {"robot_cfg", "kinematics"})
      if (at.IsMap() && at[above]) at.reset(at[above]);
    if (!at.IsMap() || !at["collision_spheres"]) refuse(file, "has no collision_spheres");
    const YAML::Node links = at["collision_spheres"];
    if (links.IsScalar())
      refuse(file, "its spheres are in another file, " + io::quoted(links.Scalar()) + ": give that one");
    if (!links.IsMap() || links.size() == 0) refuse(file, "its collision_spheres name no link");
    for (const auto& link : links) {
      if (!link.first.IsScalar()) refuse(file, "a link's name is no word");
      const std::string name = link.first.Scalar();
      if (!names.insert(name).second) refuse(file, "has link " + io::quoted(name) + " twice");
      parts.push_back(detail::yaml_link(link.first, link.second, file));
      spheres += parts.back().spheres.spheres.size();
      if (spheres > bytes.size() / 8)  // {center: [0,0,0], radius: 1}; only aliases could pack them tighter
        refuse(file, "repeats its spheres by aliases, more than its size allows");
    }
  } catch (const YAML::Exception& error) {
    refuse(file, "is no YAML: " + error.msg, std::size_t(std::max(0, error.mark.line + 1)));
  }
  return parts;
}

/// Saves each link's spheres with every float exact; the certificates are lost. Throws std::runtime_error for a name
/// that is not UTF-8, because YAML would hold another one.
inline void save_spheres_yaml(std::span<const packed_part> parts, const std::string& file) {
  YAML::Emitter out;
  out << YAML::BeginMap << YAML::Key << "collision_spheres" << YAML::Value << YAML::BeginMap;
  for (const packed_part& part : parts) {
    if (!is_utf8(part.name))
      refuse(file, "the name " + io::quoted(part.name) + " is not UTF-8, and YAML cannot hold it");
    out << YAML::Key << YAML::DoubleQuoted << part.name << YAML::Value << YAML::BeginSeq;
    for (const inner_sphere& s : part.spheres.spheres)
      out << YAML::BeginMap << YAML::Key << "center" << YAML::Value << YAML::Flow << YAML::BeginSeq
          << shortest(s.center.x) << shortest(s.center.y) << shortest(s.center.z) << YAML::EndSeq << YAML::Key
          << "radius" << YAML::Value << shortest(s.radius) << YAML::EndMap;
    out << YAML::EndSeq;
  }
  out << YAML::EndMap << YAML::EndMap;
  if (!out.good()) refuse(file, "the spheres cannot be written as YAML: " + out.GetLastError());
  write_bytes(file, std::string(out.c_str()) + '\n');
}

}  // namespace clearance::io
