// SPDX-License-Identifier: BSD-3-Clause
#include "distances.hpp"

template clearance::point_distances robot_on_backend<clearance::host>::distances(poses_of, double);
