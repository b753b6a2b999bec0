// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/device.cuh>
#include <clearance/questions/min_distances.hpp>

#include "plan.hpp"

template clearance::min_distances_result robot_on_backend<clearance::device>::plan(poses_of, double);
template clearance::min_distances_per_part_result robot_on_backend<clearance::device>::certain_plan(
    poses_of, double, const std::vector<double>&);
