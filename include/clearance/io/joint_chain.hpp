// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From a robot description to a joint chain, which poses many configurations at once.

#include <clearance/io/kinematics.hpp>
#include <clearance/robot/joint_chain.hpp>

namespace clearance::io {

/// A kinematic tree's links for many configurations at once, on any backend. Part k is link `links[k]`; the base is at
/// `base`. Poses agree with kinematic_tree::link_poses up to double's rounding; a chain gives the same poses on every
/// backend. Throws std::invalid_argument if a link does not exist, no joint moves, or `base` is not rigid.
inline joint_chain<> joint_chain_of(const kinematic_tree& tree, std::span<const std::size_t> links,
                                    joint_options options = {},
                                    const Eigen::Isometry3d& base = Eigen::Isometry3d::Identity()) {
  std::vector<chain_link> all(tree.links().size());
  for (std::size_t link = 0; link < all.size(); ++link) {
    const std::size_t above = tree.joint_above(link);
    if (above == tree.none) continue;
    const joint& by = tree.joints()[above];
    all[link].origin = world_transform(by.origin);
    all[link].parent = std::uint32_t(tree.link(by.parent));
    if (by.kind == joint_kind::fixed) continue;
    const joint_drive& drive = tree.drive(above);
    if (!(drive.offsets <= 0x1p22))
      throw std::invalid_argument("joint \"" + by.name + "\" follows by offsets beyond 2^22 (rad, m)");
    all[link].axis = {by.axis.x(), by.axis.y(), by.axis.z()};
    all[link].value = std::uint32_t(drive.value), all[link].factor = drive.factor, all[link].offset = drive.offset;
    all[link].slides = by.kind == joint_kind::prismatic;
  }
  std::vector<std::uint32_t> of_part;
  for (const std::size_t link : links) {
    if (link >= all.size())
      throw std::invalid_argument("the robot has " + std::to_string(all.size()) + " links, and none of number " +
                                  std::to_string(link));
    of_part.push_back(std::uint32_t(link));
  }
  std::vector<joint_value> values;
  for (std::size_t i = 0; i < tree.size(); ++i)
    values.push_back({tree.movable(i).name, options.ignore_limits
                                                ? joint_range{}
                                                : joint_range{tree.movable(i).lower, tree.movable(i).upper}});
  return joint_chain<>(std::move(all), std::move(of_part), std::move(values), base);
}
/// The same for a robot with its parts.
template <class Robot>
  requires requires(const Robot& r) { r.kinematics().joints(), r.parts()[0].link; }
joint_chain<> joint_chain_of(const Robot& robot, joint_options options = {},
                             const Eigen::Isometry3d& base = Eigen::Isometry3d::Identity()) {
  std::vector<std::size_t> links;
  for (const auto& part : robot.parts()) links.push_back(part.link);
  return joint_chain_of(robot.kinematics(), links, options, base);
}

}  // namespace clearance::io
