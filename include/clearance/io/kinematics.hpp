// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The joints of a robot, and where they put its links, in double. What rounding would spoil is refused.

#include <clearance/io/same_eigen.hpp>

#include <Eigen/Geometry>

#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace clearance::io {

enum class joint_kind { fixed, revolute, continuous, prismatic };

/// Its value is multiplier * (value of the joint named) + offset.
struct mimic {
  std::string joint;
  double multiplier = 1, offset = 0;
};

/// parent-from-child is `origin`, then the motion by the joint's value (radians, metres) about or along `axis`.
struct joint {
  std::string name;
  joint_kind kind = joint_kind::fixed;
  std::string parent, child;
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  std::optional<mimic> follows;

  bool movable() const { return kind != joint_kind::fixed && !follows; }
  bool turns() const { return kind == joint_kind::revolute || kind == joint_kind::continuous; }
};

/// How a joint follows the configuration, directly or through others: its value is `factor` times value number `value`
/// plus `offset`, a sum of numbers whose magnitudes add up to `offsets`. Fixed joints follow nothing.
struct joint_drive {
  std::size_t value = std::size_t(-1);
  double factor = 0, offset = 0, offsets = 0;
};

struct joint_options {
  bool ignore_limits = false;
};

/// `outer` * `inner`, such as a base and its link. Throws std::invalid_argument if both are so long, and cancel so
/// well, that double loses more than a bracket covers; `who` names what is placed there.
Eigen::Isometry3d carried(const Eigen::Isometry3d& outer, const Eigen::Isometry3d& inner, const std::string& who);

/// Links joined to a tree. A configuration is one value per movable joint that follows no other, in the order of the
/// joints as given. Joints that follow another do so even beyond their own limits.
class kinematic_tree {
 public:
  kinematic_tree() = default;

  /// Throws std::invalid_argument with the joint's name if the joints do not make one tree of all links, or if an
  /// origin, axis, limit or mimic makes no sense.
  kinematic_tree(std::vector<std::string> links, std::vector<joint> joints);

  const std::vector<std::string>& links() const { return links_; }
  const std::vector<joint>& joints() const { return joints_; }
  std::size_t base() const { return base_; }

  /// The number of values in a configuration, and the joint of each.
  std::size_t size() const { return movable_.size(); }
  const joint& movable(std::size_t i) const { return joints_[movable_[i]]; }

  /// The number of the joint above a link (`none` for the base), and what drives a joint.
  static constexpr std::size_t none = std::size_t(-1);
  std::size_t joint_above(std::size_t link) const { return above_[link]; }
  const joint_drive& drive(std::size_t joint) const { return drives_[joint]; }

  /// The number of a link. Throws std::invalid_argument if no link has this name.
  std::size_t link(const std::string& name) const;

  /// Each joint at 0, or at the limit nearest to it.
  std::vector<double> rest() const;

  /// The configuration in which the named joints have these values and the others are at rest.
  std::vector<double> configuration(const std::map<std::string, double>& values, joint_options options = {}) const;

  /// base-from-link for every link, composed in double. Throws std::invalid_argument if the number of values is wrong,
  /// if a value is not finite or beyond its limits, if a link turns by more than 2^30 rad (2^22 by a factor and an
  /// offset), if its place is not finite, or if the ways to it are so long and cancel so well that double loses more
  /// than a bracket covers.
  std::vector<Eigen::Isometry3d> link_poses(std::span<const double> q, joint_options options = {}) const;

 private:
  struct step {
    std::size_t joint, parent, child;
  };
  struct follower {
    std::size_t joint, leader;
  };

  void check(joint& j) const;

  void order_links();

  /// Puts leaders before those that follow them.
  void order_values();

  void follow(std::size_t j, std::size_t leader);

  std::size_t find(const std::string& name, const std::string& for_whom) const;

  std::size_t value_of(const std::string& name) const;

  static void check_value(const joint& j, double value, joint_options options);

  std::vector<std::string> links_;
  std::vector<joint> joints_;
  std::map<std::string, std::size_t> link_at_, joint_at_;
  std::vector<std::size_t> movable_, above_;
  std::vector<joint_drive> drives_;
  std::vector<follower> followers_;
  std::vector<step> steps_;
  std::size_t base_ = 0;
};

}  // namespace clearance::io
