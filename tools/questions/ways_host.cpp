// SPDX-License-Identifier: BSD-3-Clause
#include "hidden_ways.hpp"
#include "ways.hpp"

template std::vector<clearance::motion_clearance_result> robot_on_backend<clearance::host>::ways(
    std::span<const clearance::io::joint_motion>, const clearance::motion_clearance_options&);
template std::vector<clearance::motion_clearance_result> robot_on_backend<clearance::host>::hidden_ways(
    std::span<const clearance::io::joint_motion>, const clearance::motion_clearance_options&, const clearance::unseen&);
