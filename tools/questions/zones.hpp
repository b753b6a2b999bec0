// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "robot_on.hpp"

#include <clearance/zones.hpp>

template <class Backend>
clearance::zones_result robot_on_backend<Backend>::zones(poses_of poses, const clearance::zones_options& options) {
  return with_usual_trees([&](const auto& trees) { return clearance::zones(on_, trees, poses, clouds_, options); });
}
