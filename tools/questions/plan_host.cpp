// SPDX-License-Identifier: BSD-3-Clause
#include "plan.hpp"

template clearance::min_distances_result robot_on_backend<clearance::host>::plan(poses_of, double);
template clearance::min_distances_per_part_result robot_on_backend<clearance::host>::certain_plan(
    poses_of, double, const std::vector<double>&);
