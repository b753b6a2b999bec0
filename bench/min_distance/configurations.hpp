// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Many configurations of the benchmarks' robot: random, or along a trajectory.
#include "scene.hpp"

#include <array>
#include <cmath>
#include <random>

namespace bench {

/// The joints of the KUKA if its data is there; otherwise its stand-in turns about its base, and sways.
class moved_robot {
 public:
  explicit moved_robot(const scene& s) : scene_(s) {
    if (s.name == "kuka") robot_.push_back(load_kuka(CLEARANCE_TEST_DATA));
  }
  /// `joints`: seven angles, in radians.
  std::vector<Eigen::Isometry3d> poses(const std::array<double, 7>& joints) const {
    if (!robot_.empty()) return robot_[0].poses(joints);
    const Eigen::Isometry3d turn(Eigen::AngleAxisd(joints[0], Eigen::Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(joints[1] / 4, Eigen::Vector3d::UnitY()));
    std::vector<Eigen::Isometry3d> all;
    for (const auto& pose : scene_.poses) all.push_back(turn * pose);
    return all;
  }

 private:
  const scene& scene_;
  std::vector<clearance::io::robot> robot_;  // one, or none
};

/// Random joints up to 2 rad, within all limits.
inline std::vector<Eigen::Isometry3d> random_configurations(std::size_t count) {
  const moved_robot robot(the_scene());
  std::mt19937 bits(5);
  std::vector<Eigen::Isometry3d> all;
  for (std::size_t c = 0; c < count; ++c) {
    std::array<double, 7> joints;
    for (double& j : joints) j = 4.0 * (double(bits()) / 4294967296.0) - 2.0;
    const auto poses = robot.poses(joints);
    all.insert(all.end(), poses.begin(), poses.end());
  }
  return all;
}

/// A sweep over the table, from the scene's configuration, about half a radian each way.
inline std::vector<Eigen::Isometry3d> trajectory(std::size_t count) {
  const moved_robot robot(the_scene());
  std::vector<Eigen::Isometry3d> all;
  for (std::size_t c = 0; c < count; ++c) {
    const double t = 2 * double(c) / double(count);
    const auto poses = robot.poses({0.5 * std::sin(3 * t), 0.6 + 0.2 * std::sin(5 * t), 0.3 * t,
                                    -1.4 + 0.3 * std::sin(4 * t), 0, 0.5 + 0.4 * t, 0});
    all.insert(all.end(), poses.begin(), poses.end());
  }
  return all;
}

/// The scene's frame as seen a moment later: with 1 mm of noise.
inline std::vector<clearance::vec3> next_frame(const std::vector<clearance::vec3>& frame, unsigned seed) {
  std::mt19937 bits(seed);
  std::normal_distribution<float> noise(0, 0.001f);
  auto next = frame;
  for (auto& p : next) p.z += noise(bits);
  return next;
}

}  // namespace bench
