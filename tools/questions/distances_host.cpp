// SPDX-License-Identifier: BSD-3-Clause
#include "distances.hpp"

template clearance::point_distances robot_on_backend<clearance::host>::distances(poses_of, double, bool);
template std::vector<clearance::part_witness> robot_on_backend<clearance::host>::witnesses(
    poses_of, std::span<const clearance::part_minimum>);
