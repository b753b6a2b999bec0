// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far the robot is from what its cameras hide.

#include "robot_on.hpp"

#include <clearance/questions/unseen.hpp>

template <class Backend>
clearance::unseen_result robot_on_backend<Backend>::unseen(poses_of poses, const clearance::unseen& options) {
  if (any_uncertain_)
    return with_usual_trees([&](const auto& trees) { return clearance::ask(on_, trees, poses, uncertain_, options); });
  std::vector<clearance::placed<clearance::depth_image<std::uint16_t>>> images;
  for (const placed_points& cloud : clouds_)
    images.push_back(std::get<clearance::placed<clearance::depth_image<std::uint16_t>>>(cloud));
  return with_usual_trees([&](const auto& trees) { return clearance::ask(on_, trees, poses, images, options); });
}
