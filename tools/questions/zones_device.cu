// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/device.cuh>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/zones.hpp>

#include "zones.hpp"

template clearance::zones_result robot_on_backend<clearance::device>::zones(poses_of, const clearance::zones&);
template clearance::self_filter_result robot_on_backend<clearance::device>::own_points(poses_of, double);
template clearance::supported_distance robot_on_backend<clearance::device>::supported(
    poses_of, const clearance::min_distance_supported&);
template clearance::nearest_k_result robot_on_backend<clearance::device>::nearest(poses_of, std::size_t, double);
