// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far a robot's parts may be from where its joints say they are.

#include <clearance/ground/borrowed.hpp>
#include <clearance/io/kinematics.hpp>
#include <clearance/motion.hpp>
#include <clearance/questions/certain_distance.hpp>

#include <span>
#include <vector>

namespace clearance::io {

/// What of a configuration is not certain: one number for each of its values (rad, m), or none for 0.
struct joint_uncertainty {
  borrowed<double> errors = {};  ///< By how much each may be wrong: 0 or more.
  borrowed<double> speeds = {};  ///< How fast each changes, per second, either way.
  double delay = 0;              ///< Seconds from when the joints were read to when the answer counts.
};

/// How far each part's solid may be from where configuration `q` has it. Part k is link `links[k]`, with `facts[k]`.
/// Each joint turns what is below it by its error, and at most by its lever: the farthest that the part's ball, moved
/// by the joints below, is from the axis. Throws std::invalid_argument as link_poses, for numbers of links, facts,
/// errors or speeds that are wrong, and for an error or delay that is negative or one that is not finite.
std::vector<part_radius> part_radii(const kinematic_tree& tree, std::span<const std::size_t> links,
                                    std::span<const part_facts> facts, std::span<const double> q,
                                    const joint_uncertainty& of, joint_options options = {});

/// `part_radii` of a robot, whose parts name their links.
template <class Robot>
  requires requires(const Robot& r) { r.kinematics().joints(), r.parts()[0].link; }
std::vector<part_radius> part_radii(const Robot& robot, std::span<const part_facts> facts, std::span<const double> q,
                                    const joint_uncertainty& of, joint_options options = {}) {
  std::vector<std::size_t> links;
  for (const auto& part : robot.parts()) links.push_back(part.link);
  return part_radii(robot.kinematics(), links, facts, q, of, options);
}

}  // namespace clearance::io
