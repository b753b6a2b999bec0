// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Many configurations as a caller gives them: poses, or joint vectors of a chain.

#include <clearance/ground/numbered.hpp>
#include <clearance/robot/joint_chain.hpp>

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace clearance::plan {

/// The number of configurations. Throws std::invalid_argument if the last one is not whole.
inline std::size_t count_configurations(std::size_t parts, std::size_t poses) {
  if (parts == 0 ? poses != 0 : poses % parts != 0)
    throw std::invalid_argument("clearance: " + std::to_string(poses) + " poses are no whole configurations of " +
                                std::to_string(parts) + " parts");
  return parts == 0 ? 0 : poses / parts;
}

/// How many trajectories of `horizon` configurations there are in `all`, [batch, horizon]. Throws std::invalid_argument
/// if one is not whole.
inline std::size_t count_trajectories(std::size_t all, std::size_t horizon) {
  if (horizon == 0 || all % horizon != 0)
    throw std::invalid_argument("clearance: " + std::to_string(all) + " configurations are no whole trajectories of " +
                                std::to_string(horizon));
  return all / horizon;
}

/// Trajectory `i` of them. Throws std::out_of_range if there is none.
template <class T>
std::span<const T> trajectory_of(std::span<const T> all, std::size_t i, std::size_t horizon) {
  check_number("trajectory", i, count_trajectories(all.size(), horizon));
  return all.subspan(i * horizon, horizon);
}

/// For each trajectory the configuration that `found(trajectory)` returns.
template <class T, class Find>
std::vector<std::size_t> first_of_each(std::span<const T> all, std::size_t horizon, const Find& found) {
  std::vector<std::size_t> first(count_trajectories(all.size(), horizon));
  for (std::size_t i = 0; i < first.size(); ++i) first[i] = found(trajectory_of(all, i, horizon));
  return first;
}

/// Throws std::invalid_argument if a chain belongs to another robot.
template <class Chain>
const Chain& checked_chain(const Chain& chain, std::size_t parts) {
  if (parts != chain.parts())
    throw std::invalid_argument("clearance: there are " + std::to_string(parts) + " parts, but a joint chain of " +
                                std::to_string(chain.parts()));
  return chain;
}

/// Calls `f`. If it throws because one of the poses is not rigid, the message names the configuration.
template <class Poses, class F>
void named(std::size_t parts, const Poses& poses, const F& f) {
  try {
    f();
  } catch (const std::invalid_argument&) {
    std::size_t i = 0;
    for (const Eigen::Isometry3d& pose : poses) {
      const std::string whose = "configuration " + std::to_string(i / parts) + "'s part";
      rigid_transform_of(pose, whose.c_str(), std::int64_t(i++ % parts));
    }
    throw;
  }
}

}  // namespace clearance::plan
