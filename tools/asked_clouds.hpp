// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "asked_robot.hpp"
#include "observations.hpp"

/// The clouds of --cloud: the files as read, and views of them that questions take. Notes are shown to the user.
struct asked_clouds {
  std::vector<observation> files;
  std::vector<Eigen::Isometry3d> carriers;  // world-from-link of each cloud's --camera-link
  std::vector<seen_points> seen;
  std::vector<std::vector<clearance::vec3>> hidden;  // by cloud: what hide() removed, in the frame of `seen`

  /// Reads the files.
  void load(const query_options& asked, progress& shown, std::vector<std::string>& notes);

  /// Call this once they are loaded. `joints`: the configuration in which they were seen, as it was `off` seconds
  /// before or after; `poses`: where the parts will be.
  void place(const query_options& asked, const asked_robot& robot, const std::vector<double>& joints, poses_of poses,
             double off = 0);

  /// Removes the robot's own points, so that other questions do not see them; show `seen` to a backend again. (Masked
  /// clouds would spare that, but as one more type all questions would be compiled once more.)
  void hide(std::span<const clearance::point_label> labels);
};
