// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/joint_motion.hpp>

#include <clearance/io/kinematics.hpp>
#include <clearance/motion.hpp>

namespace clearance::io {

joint_motion::joint_motion(const kinematic_tree& tree, std::vector<std::size_t> links, std::span<const double> from,
                           std::span<const double> to, joint_options options, const Eigen::Isometry3d& base)
    : tree_(&tree),
      links_(std::move(links)),
      from_(from.begin(), from.end()),
      to_(to.begin(), to.end()),
      base_(rigid(base, "the base")) {
  tree.link_poses(from, options);
  tree.link_poses(to, options);
  for (const std::size_t link : links_)
    if (link >= tree.links().size())
      throw std::invalid_argument("the robot has " + std::to_string(tree.links().size()) +
                                  " links, and none of number " + std::to_string(link));
}

moment joint_motion::at(double t, std::span<const part_facts> parts) const {
  if (parts.size() != links_.size())
    throw std::invalid_argument("clearance: there are " + std::to_string(parts.size()) + " parts, but a motion of " +
                                std::to_string(links_.size()));
  std::vector<double> q;
  for (std::size_t i = 0; i < from_.size(); ++i) q.push_back(std::lerp(from_[i], to_[i], t));
  std::vector<Eigen::Isometry3d> poses =
      tree_->link_poses(q, {.ignore_limits = true});  // between two that were checked
  for (Eigen::Isometry3d& pose : poses) pose = base_ * pose;
  moment now;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    now.poses.push_back(poses[links_[k]]);
    now.travels.push_back(travel(poses, links_[k], parts[k]));
  }
  return now;
}

part_travel joint_motion::travel(const std::vector<Eigen::Isometry3d>& poses, std::size_t link,
                                 const part_facts& facts) const {
  const double radius = solid_radius(facts);
  const Eigen::Vector3d center = poses[link] * center_of(facts);
  double far = center_of(facts).norm() + radius, below = 0, rough = frames::pose_error;
  part_travel sum{0, 0, 0, 0};

  for (std::size_t j; (j = tree_->joint_above(link)) != tree_->none; link = tree_->link(tree_->joints()[j].parent)) {
    const joint& by = tree_->joints()[j];
    double most = 0;
    if (by.kind != joint_kind::fixed) {
      const joint_drive& drive = tree_->drive(j);
      const double a = from_[drive.value], b = to_[drive.value], rate = std::abs(drive.factor * (b - a));
      most = std::abs(drive.factor) * std::max(std::abs(a), std::abs(b)) + drive.offsets;
      if (by.kind == joint_kind::prismatic) {
        sum.speed += rate;
        sum.most += rate;
        below += rate;
      } else if (rate > 0) {
        const Eigen::Vector3d arm = center - poses[link].translation();
        sum.speed += rate * std::min(far, arm.cross(poses[link].linear() * by.axis).norm() + radius);
        sum.growth += rate * below;
        sum.most += rate * far;
        below += rate * far;
      }
    }
    // The rounding of values and origins, as a turn; `far` contains a prismatic joint's value as well.
    rough += frames::pose_error * (2 + most) + 4 * skew(world_transform(by.origin));
    far += by.origin.translation().norm() + (by.kind == joint_kind::prismatic ? most : 0);
  }

  sum.rounding = rough * (far + base_.translation().norm());
  for (double* x : {&sum.speed, &sum.growth, &sum.most}) *x *= 1 + rough;
  return sum;
}

}  // namespace clearance::io
