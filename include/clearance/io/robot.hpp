// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Reads a robot from its URDF file: its parts with their meshes, and the joints that move them.

#include <clearance/io/kinematics.hpp>
#include <clearance/io/limits.hpp>
#include <clearance/io/mesh.hpp>
#include <clearance/solid/triangle_mesh.hpp>

#include <Eigen/Geometry>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
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
  std::optional<gltf_axis> gltf_up{};           // without it as glTF meshes fit other geometry, else y, with a note
};

/// One link that has geometry: all its meshes and shapes as one mesh in the link's frame, in the file's order.
struct robot_part {
  std::string name;
  triangle_mesh mesh;
  double tessellation_error = 0;  // the link's shapes reach at most this far beyond the mesh, metres; 0 for meshes
  robot_geometry used = robot_geometry::collision;
  std::size_t link = 0;  // its number in the kinematic tree
};

// Joints that follow others by <mimic>, where somebody says their own values: a value that is said wins.

/// The `names` of joints of the tree that follow others.
std::vector<std::string> followers_among(const kinematic_tree& tree, const std::vector<std::string>& names);

/// A copy of the tree in which the named joints follow no other: each has a value of its own in a configuration, at its
/// place in the order of joints, within its own limits. What follows them goes on to. As robot_state_publisher has it,
/// where the published value of such a joint wins. Throws std::invalid_argument for a name of no joint that follows
/// another.
kinematic_tree freed(const kinematic_tree& tree, const std::vector<std::string>& names);

/// The sentence that tells a user of a freed joint.
std::string note_on_freed(const kinematic_tree& tree, const std::string& name);

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

  /// Makes joints follow no other any more: see `freed`.
  void free_joints(const std::vector<std::string>& names) { tree_ = freed(tree_, names); }

  /// base-from-part for each part; see kinematic_tree::link_poses.
  std::vector<Eigen::Isometry3d> poses(std::span<const double> configuration, joint_options options = {}) const;

  /// base-from-link for any link, with geometry or not.
  Eigen::Isometry3d link_pose(const std::string& link, std::span<const double> configuration,
                              joint_options options = {}) const;

 private:
  std::string name_;
  kinematic_tree tree_;
  std::vector<robot_part> parts_;
  std::vector<std::string> notes_;
};

/// Reads a URDF file and all its geometry. A part is a link that has geometry; parts keep the file's order. Throws
/// std::runtime_error if a file is damaged or missing, std::invalid_argument if a link to exclude does not exist.
robot load_robot(const std::filesystem::path& urdf, const robot_options& options = {});
/// The same of a description's text, such as ROS's robot_description. Meshes are found as from a file at `beside`,
/// which need not exist; errors call the text so.
robot load_robot_text(std::string_view text, const std::filesystem::path& beside, const robot_options& options = {});

}  // namespace clearance::io
