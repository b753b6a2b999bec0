// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/robot.hpp>

#include "io/near_word.hpp"
#include "io/robot_link.hpp"

#include <clearance/io/kinematics.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace clearance::io {

std::vector<std::string> followers_among(const kinematic_tree& tree, const std::vector<std::string>& names) {
  std::vector<std::string> found;
  for (const joint& j : tree.joints())
    if (j.follows && std::ranges::find(names, j.name) != names.end()) found.push_back(j.name);
  return found;
}

kinematic_tree freed(const kinematic_tree& tree, const std::vector<std::string>& names) {
  if (names.empty()) return tree;
  std::vector<joint> joints = tree.joints();
  for (const std::string& name : names) {
    const auto found = std::ranges::find(joints, name, &joint::name);
    if (found == joints.end() || !found->follows)
      throw std::invalid_argument("the robot has no joint \"" + name + "\" that follows another");
    found->follows.reset();
  }
  return kinematic_tree(tree.links(), std::move(joints));
}

std::string note_on_freed(const kinematic_tree& tree, const std::string& name) {
  const auto found = std::ranges::find(tree.joints(), name, &joint::name);
  return "joint \"" + name + "\" has a value of its own here, which wins over what it would follow \"" +
         found->follows->joint + "\" to by <mimic>";
}

namespace {

// Which axis of a robot's glTF meshes is up. The format says y; many robots are made with z, and nothing in a file
// tells. A link that has other geometry besides tells: only one of the two readings fits it.

bool names_gltf(const urdf_shape& shape) {
  const auto* mesh = std::get_if<urdf_mesh>(&shape.geometry);
  if (!mesh) return false;
  const std::string end = lower_case(std::filesystem::path(mesh->uri).extension().string());
  return end == ".glb" || end == ".gltf";
}

bool name_gltf(const std::vector<urdf_shape>& shapes) { return std::ranges::any_of(shapes, names_gltf); }

/// How far two boxes differ in any direction, against the size of the second.
double box_difference(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) {
  const double off = std::max((a.min() - b.min()).cwiseAbs().maxCoeff(), (a.max() - b.max()).cwiseAbs().maxCoeff());
  return off / b.diagonal().norm();
}

/// Decides which axis is up, link by link.
class gltf_judge {
 public:
  /// Reads the geometry of links that have glTF meshes and something else to compare. What cannot be read is left out:
  /// whoever needs it says so.
  gltf_judge(const std::filesystem::path& urdf, const robot_options& options, const std::vector<urdf_link>& links)
      : asked_(options.gltf_up) {
    if (asked_) return;
    for (const urdf_link& link : links) {
      if (link.collision.empty() || link.visual.empty() || name_gltf(link.collision) == name_gltf(link.visual))
        continue;
      if (std::ranges::find(options.exclude_links, link.name) != options.exclude_links.end()) continue;
      const bool visual = name_gltf(link.visual);
      const auto other = box_of(urdf, options, link, visual ? link.collision : link.visual, gltf_axis::y);
      const auto& shapes = visual ? link.visual : link.collision;
      const auto y = box_of(urdf, options, link, shapes, gltf_axis::y),
                 z = box_of(urdf, options, link, shapes, gltf_axis::z);
      if (!other || !y || !z || !(other->diagonal().norm() > 0)) continue;
      const double as_y = box_difference(*y, *other), as_z = box_difference(*z, *other);
      // One of them has to fit, and the other clearly not: a ball or a cube tells nothing.
      if (std::min(as_y, as_z) <= 0.1 && std::max(as_y, as_z) >= std::max(0.05, 4 * std::min(as_y, as_z)))
        fits_[link.name] = as_y < as_z ? gltf_axis::y : gltf_axis::z;
    }
  }

  /// The axis for a link's meshes, if it was asked for or they are named as glTF is, which gets a note.
  std::optional<gltf_axis> of(const std::string& link, const std::vector<urdf_shape>& shapes, note_tally& notes) const {
    if (asked_) return *asked_;
    if (!name_gltf(shapes)) return std::nullopt;
    const auto own = fits_.find(link);
    const gltf_axis up = own != fits_.end() ? own->second : usual();
    const std::string axis = up == gltf_axis::y ? "y" : "z", other = up == gltf_axis::y ? "z" : "y";
    notes.add("has glTF meshes, which are read with " + axis + " up: " +
                  (own != fits_.end() ? "so they fit the link's other geometry, and with " + other + " up they do not"
                   : !fits_.empty() && agree() ? "so those of other links fit their other geometry"
                                               : std::string("the format has it so, and no other geometry tells")) +
                  " (--gltf-up y or z decides)",
              "link " + io::quoted(link));
    return up;
  }

 private:
  /// That of the links that tell, if they agree; else the format's.
  gltf_axis usual() const { return !fits_.empty() && agree() ? fits_.begin()->second : gltf_axis::y; }
  bool agree() const {
    return std::ranges::all_of(fits_, [&](const auto& each) { return each.second == fits_.begin()->second; });
  }

  static std::optional<Eigen::AlignedBox3d> box_of(const std::filesystem::path& urdf, const robot_options& options,
                                                   const urdf_link& link, const std::vector<urdf_shape>& shapes,
                                                   gltf_axis up) {
    try {
      note_tally unheard;
      robot_reader reader(urdf, options, shapes.size(), unheard);
      robot_part part{link.name, {}, 0, robot_geometry::collision, 0};
      Eigen::AlignedBox3d box;
      for (const urdf_shape& shape : shapes) reader.add(part, shape, up);
      for (const auto& t : part.mesh.triangles)
        for (const auto v : t) box.extend(part.mesh.vertices[v]);
      if (!box.isEmpty()) return box;
    } catch (const std::exception&) {
    }
    return std::nullopt;
  }

  std::optional<gltf_axis> asked_;
  std::map<std::string, gltf_axis> fits_;  // links whose meshes fit in one way alone
};

/// What `read` returns, with its geometry; `urdf` is where meshes are looked for from.
template <class Read>
robot robot_of(const std::filesystem::path& urdf, const robot_options& options, Read read) {
  if (!(options.tessellation > 0)) throw std::invalid_argument("the tessellation error must be above 0");
  urdf_file file = within_memory(urdf.string(), read);
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
  robot_reader reader(urdf, options, round, file.notes);
  std::optional<gltf_judge> judge;  // reads more than the robot needs, so only if a mesh is glTF

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
    if (!judge && name_gltf(shapes(link))) judge.emplace(urdf, options, file.links);
    const std::optional<gltf_axis> up = judge ? judge->of(link.name, shapes(link), file.notes) : options.gltf_up;
    for (const urdf_shape& shape : shapes(link)) {
      if (shape.flat())
        file.notes.add("has a shape without volume (a side, radius or length is 0), which is taken as 0.002 mm thick",
                       "link " + io::quoted(part.name), shape.line);
      within_memory(urdf.string(), [&] { reader.add(part, shape, up); });
    }
    parts.push_back(std::move(part));
  }

  if (parts.empty())
    refuse(urdf.string(),
           options.exclude_links.empty() ? "no link has geometry" : "no link that is not excluded has geometry");
  for (const std::string& name : reader.unused_packages())
    file.notes.add("was given, and no mesh that was read is in it", "package " + io::quoted(name));
  return {file.name, file.tree, std::move(parts), file.notes.sentences()};
}

}  // namespace

std::vector<Eigen::Isometry3d> robot::poses(std::span<const double> configuration, joint_options options) const {
  const auto link_poses = tree_.link_poses(configuration, options);
  std::vector<Eigen::Isometry3d> made;
  for (const auto& part : parts_) made.push_back(link_poses[part.link]);
  return made;
}

Eigen::Isometry3d robot::link_pose(const std::string& link, std::span<const double> configuration,
                                   joint_options options) const {
  return tree_.link_poses(configuration, options)[tree_.link(link)];
}

robot load_robot(const std::filesystem::path& urdf, const robot_options& options) {
  return robot_of(urdf, options, [&] { return read_urdf(urdf.string(), options.limits, options.strict); });
}

robot load_robot_text(std::string_view text, const std::filesystem::path& beside, const robot_options& options) {
  return robot_of(beside, options,
                  [&] { return read_urdf_text(text, beside.string(), options.limits, options.strict); });
}

}  // namespace clearance::io
