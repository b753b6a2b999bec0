// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "asked_robot.hpp"
#include "observations.hpp"

/// The clouds of --cloud: what was read, and what a question takes of it, which views the former. Notes are what a user
/// should see.
struct asked_clouds {
  std::vector<observation> files;
  std::vector<Eigen::Isometry3d> carriers;  // world-from-link of each cloud's --camera-link
  std::vector<seen_points> seen;
  std::vector<std::vector<clearance::vec3>> hidden;  // of each cloud what hide() took away, in the frame of `seen`

  /// Reads the files.
  void load(const query_options& asked, progress& shown, std::vector<std::string>& notes);

  /// To be called once they are loaded. `joints`: the configuration in which they were seen; `poses`: where parts will
  /// be.
  void place(const query_options& asked, const clearance::io::robot& robot, const std::vector<double>& joints,
             poses_of poses);

  /// Takes away what is the robot's own: other questions are asked without it, once `seen` is shown to a backend anew.
  /// (Masked clouds would spare that, but they are one more type, for which all questions would be compiled again.)
  void hide(std::span<const clearance::point_label> labels);
};
