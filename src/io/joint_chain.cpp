// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/joint_chain.hpp>

#include <clearance/io/kinematics.hpp>
#include <clearance/robot/joint_chain.hpp>

namespace clearance::io {

joint_chain<> joint_chain_of(const kinematic_tree& tree, std::span<const std::size_t> links, joint_options options,
                             const Eigen::Isometry3d& base) {
  std::vector<chain_link> made(tree.links().size());
  for (std::size_t link = 0; link < made.size(); ++link) {
    const std::size_t above = tree.joint_above(link);
    if (above == tree.none) continue;
    const joint& by = tree.joints()[above];
    made[link].origin = world_transform(by.origin);
    made[link].parent = std::uint32_t(tree.link(by.parent));
    if (by.kind == joint_kind::fixed) continue;
    const joint_drive& drive = tree.drive(above);
    if (!(drive.offsets <= 0x1p22))
      throw std::invalid_argument("joint \"" + by.name + "\" follows by offsets beyond 2^22 (rad, m)");
    made[link].axis = {by.axis.x(), by.axis.y(), by.axis.z()};
    made[link].value = std::uint32_t(drive.value);
    made[link].factor = drive.factor;
    made[link].offset = drive.offset;
    made[link].slides = by.kind == joint_kind::prismatic;
  }

  std::vector<std::uint32_t> of_part;
  for (const std::size_t link : links) {
    if (link >= made.size())
      throw std::invalid_argument("the robot has " + std::to_string(made.size()) + " links, and none of number " +
                                  std::to_string(link));
    of_part.push_back(std::uint32_t(link));
  }

  std::vector<joint_value> values;
  for (std::size_t i = 0; i < tree.size(); ++i)
    values.push_back({tree.movable(i).name, options.ignore_limits
                                                ? joint_range{}
                                                : joint_range{tree.movable(i).lower, tree.movable(i).upper}});
  return joint_chain<>(std::move(made), std::move(of_part), std::move(values), base);
}

}  // namespace clearance::io
