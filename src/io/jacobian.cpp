// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/jacobian.hpp>

#include <clearance/gradient.hpp>
#include <clearance/io/kinematics.hpp>

#include <Eigen/Core>

namespace clearance::io {

Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(const kinematic_tree& tree,
                                                  std::span<const Eigen::Isometry3d> link_poses, std::size_t link,
                                                  const Eigen::Vector3d& at) {
  if (link_poses.size() != tree.links().size() || link >= link_poses.size())
    throw std::invalid_argument("the robot has " + std::to_string(tree.links().size()) + " links; here are " +
                                std::to_string(link_poses.size()) + " poses and link number " + std::to_string(link));
  Eigen::Matrix<double, 6, Eigen::Dynamic> all =
      Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, Eigen::Index(tree.size()));
  for (std::size_t j; (j = tree.joint_above(link)) != tree.none; link = tree.link(tree.joints()[j].parent)) {
    const joint& by = tree.joints()[j];
    if (by.kind == joint_kind::fixed) continue;
    const joint_drive& drive = tree.drive(j);
    const Eigen::Vector3d axis =
        drive.factor * (link_poses[link].linear() * by.axis);  // motion about or along it leaves it unchanged
    auto column = all.col(Eigen::Index(drive.value));
    if (by.kind == joint_kind::prismatic) {
      column.head<3>() += axis;
    } else {
      column.head<3>() += axis.cross(at - link_poses[link].translation());
      column.tail<3>() += axis;
    }
  }
  return all;
}

std::optional<Eigen::VectorXd> joint_gradient(const kinematic_tree& tree, std::span<const Eigen::Isometry3d> link_poses,
                                              std::size_t link, const pose_gradient& g) {
  const auto moved = jacobian(tree, link_poses, link, {g.about.x, g.about.y, g.about.z});
  if (!g) return std::nullopt;
  Eigen::Matrix<double, 6, 1> by;
  by << g.linear.x, g.linear.y, g.linear.z, g.angular.x, g.angular.y, g.angular.z;
  return Eigen::VectorXd(moved.transpose() * by);
}

}  // namespace clearance::io
