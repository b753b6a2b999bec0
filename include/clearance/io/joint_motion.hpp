// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The motion of a robot whose joints go from one configuration to another, each at constant speed.

#include <clearance/io/kinematics.hpp>
#include <clearance/motion.hpp>

#include <span>
#include <string>
#include <vector>

namespace clearance::io {

/// Every joint of a robot goes from one value to another at constant speed; a mimic joint follows its own. The tree
/// must outlive the object.
class joint_motion {
 public:
  /// Part k is link `links[k]`; the base is at `base`. Throws std::invalid_argument as kinematic_tree::link_poses for
  /// either configuration, or if a link does not exist, or `base` is not rigid.
  joint_motion(const kinematic_tree& tree, std::vector<std::size_t> links, std::span<const double> from,
               std::span<const double> to, joint_options options = {},
               const Eigen::Isometry3d& base = Eigen::Isometry3d::Identity());
  template <class... Any>
  joint_motion(const kinematic_tree&&, const Any&...) = delete;  // the tree would be gone when it is asked; name it
  /// The motion of a robot, whose parts name their links.
  template <class Robot>
    requires requires(const Robot& r) { r.kinematics().joints(), r.parts()[0].link; }
  joint_motion(const Robot& robot, std::span<const double> from, std::span<const double> to, joint_options options = {},
               const Eigen::Isometry3d& base = Eigen::Isometry3d::Identity())
      : joint_motion(robot.kinematics(), links_of(robot), from, to, options, base) {}
  template <class Robot, class... Any>
    requires requires(const Robot& r) { r.kinematics().joints(), r.parts()[0].link; }
  joint_motion(const Robot&&, const Any&...) = delete;  // the robot would be gone

  /// Throws std::invalid_argument if the numbers of parts and links differ.
  moment at(double t, std::span<const part_facts> parts) const;

 private:
  template <class Robot>
  static std::vector<std::size_t> links_of(const Robot& robot) {
    std::vector<std::size_t> links;
    for (const auto& part : robot.parts()) links.push_back(part.link);
    return links;
  }

  /// Goes up the chain, joint by joint. For each joint: how far the solid is from its axis now, how far it can ever be
  /// from there (the lengths between frames add up), and how fast the joints below can change that.
  part_travel travel(const std::vector<Eigen::Isometry3d>& poses, std::size_t link, const part_facts& facts) const;

  const kinematic_tree* tree_;
  std::vector<std::size_t> links_;
  std::vector<double> from_, to_;
  Eigen::Isometry3d base_;
};

static_assert(motion<joint_motion>);

}  // namespace clearance::io
