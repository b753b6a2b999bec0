// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/deadline.hpp>
#include <clearance/device.cuh>
#include <clearance/questions/min_distance.hpp>

#include "least.hpp"

template reply robot_on_backend<clearance::device>::least(poses_of);
template reply robot_on_backend<clearance::device>::least_per_part(poses_of, int);
template reply robot_on_backend<clearance::device>::least_by(poses_of, double);
