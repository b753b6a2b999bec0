// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/robot_link.hpp>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace clearance::io {

/// The rigid parts of a robot description and how they move. The base link is at the origin.
class robot {
 public:
  robot(std::string name, kinematic_tree tree, std::vector<robot_part> parts, std::vector<std::string> notes)
      : name_(std::move(name)), tree_(std::move(tree)), parts_(std::move(parts)), notes_(std::move(notes)) {}

  const std::string& name() const { return name_; }
  const std::vector<robot_part>& parts() const { return parts_; }
  const kinematic_tree& kinematics() const { return tree_; }
  /// Sentences to show to a user, for example that a link without collision geometry uses its visual.
  const std::vector<std::string>& notes() const { return notes_; }

  /// base-from-part for each part; see kinematic_tree::link_poses.
  std::vector<Eigen::Isometry3d> poses(std::span<const double> configuration, joint_options options = {}) const {
    const auto all = tree_.link_poses(configuration, options);
    std::vector<Eigen::Isometry3d> made;
    for (const auto& part : parts_) made.push_back(all[part.link]);
    return made;
  }

  /// base-from-link for any link, with geometry or not.
  Eigen::Isometry3d link_pose(const std::string& link, std::span<const double> configuration,
                              joint_options options = {}) const {
    return tree_.link_poses(configuration, options)[tree_.link(link)];
  }

 private:
  std::string name_;
  kinematic_tree tree_;
  std::vector<robot_part> parts_;
  std::vector<std::string> notes_;
};

/// Reads a URDF file and all its geometry. A part is a link that has geometry; parts keep the file's order. Throws
/// std::runtime_error if a file is damaged or missing, std::invalid_argument if a link to exclude does not exist.
inline robot load_robot(const std::filesystem::path& urdf, const robot_options& options = {}) {
  if (!(options.tessellation > 0)) throw std::invalid_argument("the tessellation error must be above 0");
  urdf_file file =
      within_memory(urdf.string(), [&] { return read_urdf(urdf.string(), options.limits, options.strict); });
  for (const auto& name : options.exclude_links)
    if (std::none_of(file.links.begin(), file.links.end(), [&](const auto& link) { return link.name == name; }))
      throw std::invalid_argument("the robot has no link " + io::quoted(name) + " to exclude");
  const auto asked = [&](const urdf_link& link) {
    return std::ranges::find(options.exclude_links, link.name) == options.exclude_links.end() &&
           !(link.collision.empty() && link.visual.empty());
  };
  const auto shapes = [&](const urdf_link& link) -> const std::vector<urdf_shape>& {
    const bool visual = options.geometry == robot_geometry::visual;
    return (visual ? link.visual.empty() : !link.collision.empty()) ? link.collision : link.visual;
  };
  std::size_t round = 0;
  for (const urdf_link& link : file.links)
    if (asked(link)) round += std::size_t(std::ranges::count_if(shapes(link), &urdf_shape::round));
  std::vector<robot_part> parts;
  robot_reader reader(urdf, options, round);
  for (const urdf_link& link : file.links) {
    if (!asked(link)) continue;
    robot_part part{link.name, {}, 0, options.geometry, file.tree.link(link.name)};
    if (part.used == robot_geometry::collision && link.collision.empty()) {
      part.used = robot_geometry::visual;
      file.notes.add("has no collision geometry, and its visual is used", "link " + io::quoted(part.name));
    } else if (part.used == robot_geometry::visual && link.visual.empty()) {
      part.used = robot_geometry::collision;
      file.notes.add("has no visual geometry, and its collision is used", "link " + io::quoted(part.name));
    }
    for (const urdf_shape& shape : shapes(link)) {
      if (shape.flat())
        file.notes.add("has a shape without volume (a side, radius or length is 0), which is taken as 0.002 mm thick",
                       "link " + io::quoted(part.name), shape.line);
      within_memory(urdf.string(), [&] { reader.add(part, shape); });
    }
    parts.push_back(std::move(part));
  }
  if (parts.empty())
    refuse(urdf.string(),
           options.exclude_links.empty() ? "no link has geometry" : "no link that is not excluded has geometry");
  return {file.name, file.tree, std::move(parts), file.notes.sentences()};
}

}  // namespace clearance::io
