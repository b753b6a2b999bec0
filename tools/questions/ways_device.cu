// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/device.cuh>
#include <clearance/motion_clearance.hpp>
#include <clearance/questions/unseen.hpp>

#include "hidden_ways.hpp"
#include "ways.hpp"

template std::vector<clearance::motion_clearance_result> robot_on_backend<clearance::device>::ways(
    std::span<const clearance::io::joint_motion>, const clearance::motion_clearance_options&);
template std::vector<clearance::motion_clearance_result> robot_on_backend<clearance::device>::hidden_ways(
    std::span<const clearance::io::joint_motion>, const clearance::motion_clearance_options&, const clearance::unseen&);
