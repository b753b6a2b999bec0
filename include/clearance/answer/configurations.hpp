// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Many configurations as a caller gives them: poses, or joint vectors of a chain.

#include <clearance/robot/joint_chain.hpp>

#include <stdexcept>

namespace clearance::detail {

/// How many configurations that are. Throws std::invalid_argument if some are not whole.
inline std::size_t count_configurations(std::size_t parts, std::size_t poses) {
  if (parts == 0 ? poses != 0 : poses % parts != 0)
    throw std::invalid_argument("clearance: " + std::to_string(poses) + " poses are no whole configurations of " + std::to_string(parts) + " parts");
  return parts == 0 ? 0 : poses / parts;
}
/// Throws std::invalid_argument if a chain is of another robot.
inline void check_chain(std::size_t parts, std::size_t of_chain) {
  if (parts != of_chain)
    throw std::invalid_argument("clearance: there are " + std::to_string(parts) + " parts, but a joint chain of " + std::to_string(of_chain));
}
/// Calls `f`; of what it throws because a pose is not rigid the sentence says which configuration's.
template <class F>
void named(std::size_t parts, std::span<const Eigen::Isometry3d> poses, const F& f) {
  try {
    f();
  } catch (const std::invalid_argument&) {
    for (std::size_t i = 0; i < poses.size(); ++i)
      rigid_transform_of(poses[i], ("configuration " + std::to_string(i / parts) + "'s part").c_str(), std::int64_t(i % parts));
    throw;
  }
}

}  // namespace clearance::detail
