// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/device.cuh>
#include <clearance/questions/certain_distance.hpp>

#include "certain.hpp"

template clearance::certain_distance_result robot_on_backend<clearance::device>::certain(
    poses_of, std::span<const clearance::part_radius>);
