// SPDX-License-Identifier: BSD-3-Clause
#include "least.hpp"

template reply robot_on_backend<clearance::host>::least(poses_of);
template reply robot_on_backend<clearance::host>::least_per_part(poses_of, int);
template reply robot_on_backend<clearance::host>::least_by(poses_of, double);
