// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "robot_on.hpp"

#include <clearance/min_distances.hpp>

template <class Backend>
clearance::min_distances_result robot_on_backend<Backend>::plan(poses_of poses, double d_max) {
  return with_usual_trees([&](const auto& trees) { return clearance::min_distances(on_, trees, poses, clouds_, {.d_max = clearance::real(d_max)}); });
}
