// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/distances.cuh>
#include <clearance/part_witnesses.cuh>
#include <clearance/signed_distances.cuh>

#include "distances.hpp"

template clearance::point_distances robot_on_backend<clearance::device>::distances(poses_of, double, bool);
template std::vector<clearance::part_witness> robot_on_backend<clearance::device>::witnesses(
    poses_of, std::span<const clearance::part_minimum>);
