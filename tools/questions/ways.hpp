// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "robot_on.hpp"

#include <clearance/io/joint_motion.hpp>
#include <clearance/motion_clearance.hpp>

template <class Backend>
std::vector<clearance::motion_clearance_result> robot_on_backend<Backend>::ways(
    std::span<const clearance::io::joint_motion> ways, const clearance::motion_clearance_options& options) {
  return with_clouds([&](const auto& clouds) {
    return with_usual_trees([&](const auto& trees) {
      clearance::query asked(on_, trees, clearance::min_distance_per_part{});
      std::vector<clearance::motion_clearance_result> all;
      for (const clearance::io::joint_motion& way : ways)
        all.push_back(clearance::motion_clearance(asked, trees, way, clouds, options));
      return all;
    });
  });
}
