// SPDX-License-Identifier: BSD-3-Clause
#include "certain.hpp"

template clearance::certain_distance_result robot_on_backend<clearance::host>::certain(
    poses_of, std::span<const clearance::part_radius>);
