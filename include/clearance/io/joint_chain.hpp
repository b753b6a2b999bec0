// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From a robot description to a joint chain, which poses many configurations at once.

#include <clearance/io/kinematics.hpp>
#include <clearance/robot/joint_chain.hpp>

#include <span>
#include <vector>

namespace clearance::io {

/// A kinematic tree's links for many configurations at once, on any backend. Part k is link `links[k]`; the base is at
/// `base`. Poses agree with kinematic_tree::link_poses up to double's rounding; a chain gives the same poses on every
/// backend. Throws std::invalid_argument if a link does not exist, no joint moves, or `base` is not rigid.
joint_chain<> joint_chain_of(const kinematic_tree& tree, std::span<const std::size_t> links, joint_options options = {},
                             const Eigen::Isometry3d& base = Eigen::Isometry3d::Identity());

/// `joint_chain_of` a robot, whose parts name their links.
template <class Robot>
  requires requires(const Robot& r) { r.kinematics().joints(), r.parts()[0].link; }
joint_chain<> joint_chain_of(const Robot& robot, joint_options options = {},
                             const Eigen::Isometry3d& base = Eigen::Isometry3d::Identity()) {
  std::vector<std::size_t> links;
  for (const auto& part : robot.parts()) links.push_back(part.link);
  return joint_chain_of(robot.kinematics(), links, options, base);
}

}  // namespace clearance::io
