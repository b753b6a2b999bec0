// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/questions/min_distances.hpp>
#include <clearance/device.cuh>

#include "plan.hpp"

template clearance::min_distances_result robot_on_backend<clearance::device>::plan(poses_of, double);
