// SPDX-License-Identifier: BSD-3-Clause
#include "zones.hpp"

template clearance::zones_result robot_on_backend<clearance::host>::zones(poses_of, const clearance::zones&);
template clearance::self_filter_result robot_on_backend<clearance::host>::own_points(poses_of, double);
template clearance::supported_distance robot_on_backend<clearance::host>::supported(
    poses_of, const clearance::min_distance_supported&);
template clearance::nearest_k_result robot_on_backend<clearance::host>::nearest(poses_of, std::size_t, double);
