// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far the robot is from what its cameras hide.

#include "robot_on.hpp"

#include <clearance/questions/unseen.hpp>

template <class Backend>
template <class Use>
auto robot_on_backend<Backend>::with_images(bool until_end, Use use) {
  if (any_uncertain_ || until_end) return use(until_end ? until_end_ : uncertain_);
  std::vector<clearance::placed<clearance::depth_image<std::uint16_t>>> images;
  for (const placed_points& cloud : clouds_)
    images.push_back(std::get<clearance::placed<clearance::depth_image<std::uint16_t>>>(cloud));
  return use(images);
}

template <class Backend>
clearance::unseen_result robot_on_backend<Backend>::unseen(poses_of poses, const clearance::unseen& options,
                                                           bool until_end) {
  return with_images(until_end, [&](const auto& images) {
    return with_usual_trees([&](const auto& trees) { return clearance::ask(on_, trees, poses, images, options); });
  });
}
