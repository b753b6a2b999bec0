// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far the robot is from what its cameras hide.

#include "robot_on.hpp"

#include <clearance/questions/unseen.hpp>

template <class Backend>
template <class Use>
auto robot_on_backend<Backend>::with_images(bool until_end, Use use) {
  if (any_uncertain_ || until_end) return use(until_end ? images_until_end_ : uncertain_images_);
  return use(images_);
}

template <class Backend>
clearance::unseen_result robot_on_backend<Backend>::unseen(poses_of poses, const clearance::unseen& options,
                                                           bool until_end) {
  return with_images(until_end, [&](const auto& images) {
    return with_usual_trees([&](const auto& trees) { return clearance::ask(on_, trees, poses, images, options); });
  });
}
