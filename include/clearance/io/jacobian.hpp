// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Turns the change of a distance with a part's pose into its change with a robot's joints.

#include <clearance/gradient.hpp>
#include <clearance/io/kinematics.hpp>

#include <Eigen/Core>

#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace clearance::io {

/// What each value of the configuration does to a link, in the frame of `at`: 6 x tree.size(). A column is the velocity
/// of the link's point that is now at `at` (3), then the link's angular velocity (3), per metre or radian. Mimic joints
/// count for the value that they follow. `link_poses` are those of all links, from link_poses or moved together. Throws
/// std::invalid_argument if their number is wrong, or the tree has no such link.
Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(const kinematic_tree& tree,
                                                  std::span<const Eigen::Isometry3d> link_poses, std::size_t link,
                                                  const Eigen::Vector3d& at);

/// The gradient of a distance with respect to the configuration: metres per metre or radian of its values. No value if
/// the gradient with respect to the link's pose is not known. `g` and `link_poses` are in one frame. Throws as
/// jacobian.
std::optional<Eigen::VectorXd> joint_gradient(const kinematic_tree& tree, std::span<const Eigen::Isometry3d> link_poses,
                                              std::size_t link, const pose_gradient& g);

/// The same of an answer: of a witness, whose part's link `link_of` names, or of a pair of parts as `self_query` gives
/// it. No value where the distance has no gradient. Throws as jacobian.
template <class Found, class LinkOf>
std::optional<Eigen::VectorXd> joint_gradient_of(const kinematic_tree& tree,
                                                 std::span<const Eigen::Isometry3d> link_poses, const Found& found,
                                                 const LinkOf& link_of) {
  if constexpr (requires { found.at_a, found.at_b; }) {
    if (found.normal == vec3{0, 0, 0}) return std::nullopt;
    const auto share = [&](std::uint32_t part, const position& at, vec3 way) {
      const pose_gradient g{.state = gradient_state::known, .linear = way, .angular = {0, 0, 0}, .about = at};
      return *joint_gradient(tree, link_poses, link_of(part), g);
    };
    return Eigen::VectorXd(share(found.a, found.at_a, found.normal) + share(found.b, found.at_b, -found.normal));
  } else {
    const pose_gradient g = gradient(found, found.nearest);
    if (!g) return std::nullopt;
    return joint_gradient(tree, link_poses, link_of(found.part), g);
  }
}

/// `joint_gradient` for a part of a robot in configuration `q`, whose base is at `base`. Throws as
/// kinematic_tree::link_poses, or if there is no such part.
template <class Robot>
  requires requires(const Robot& r) { r.kinematics().link_poses({}), r.parts()[0].link; }
std::optional<Eigen::VectorXd> joint_gradient(const Robot& robot, std::span<const double> q, std::uint32_t part,
                                              const pose_gradient& g, joint_options options = {},
                                              const Eigen::Isometry3d& base = Eigen::Isometry3d::Identity()) {
  if (!g) return std::nullopt;
  if (part >= robot.parts().size())
    throw std::invalid_argument("the robot has " + std::to_string(robot.parts().size()) +
                                " parts, and none of number " + std::to_string(part));
  std::vector<Eigen::Isometry3d> poses = robot.kinematics().link_poses(q, options);
  for (Eigen::Isometry3d& pose : poses) pose = base * pose;
  return joint_gradient(robot.kinematics(), poses, robot.parts()[part].link, g);
}

/// What a controller's constraints take: how each of some distances changes with the configuration, [found x values].
/// `found` are witnesses in configuration `q`, such as those of min_distances_per_part, or pairs of `self_query`. A row
/// is NaN where a distance has no gradient. Throws as kinematic_tree::link_poses.
template <class Robot, class Found>
  requires requires(const Robot& r) { r.kinematics().link_poses({}), r.parts()[0].link; }
Eigen::MatrixXd joint_gradients(const Robot& robot, std::span<const double> q, const Found& found,
                                joint_options options = {},
                                const Eigen::Isometry3d& base = Eigen::Isometry3d::Identity()) {
  std::vector<Eigen::Isometry3d> poses = robot.kinematics().link_poses(q, options);
  for (Eigen::Isometry3d& pose : poses) pose = base * pose;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Constant(Eigen::Index(std::size(found)),
                                                   Eigen::Index(robot.kinematics().size()), double(not_a_number));
  Eigen::Index k = 0;
  for (const auto& one : found) {
    const auto row =
        joint_gradient_of(robot.kinematics(), poses, one, [&](std::uint32_t part) { return robot.parts()[part].link; });
    if (row) rows.row(k) = row->transpose();
    ++k;
  }
  return rows;
}

}  // namespace clearance::io
