// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "robot_on.hpp"

#include <clearance/questions/certain_distance.hpp>

template <class Backend>
clearance::certain_distance_result robot_on_backend<Backend>::certain(poses_of poses,
                                                                      std::span<const clearance::part_radius> parts) {
  return with_usual_trees([&](const auto& trees) {
    return clearance::ask(on_, trees, poses, uncertain_, clearance::certain_distance{{parts.begin(), parts.end()}});
  });
}
