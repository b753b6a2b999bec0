// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/min_support.cuh>
#include <clearance/nearest_k.cuh>
#include <clearance/self_filter.cuh>
#include <clearance/zones.cuh>

#include "zones.hpp"

template clearance::zones_result robot_on_backend<clearance::device>::zones(poses_of, const clearance::zones_options&);
template clearance::self_filter_result robot_on_backend<clearance::device>::own_points(poses_of, double);
template clearance::supported_distance robot_on_backend<clearance::device>::supported(
    poses_of, const clearance::support_options&);
template clearance::nearest_k_result robot_on_backend<clearance::device>::nearest(poses_of, std::size_t, double);
