// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/device.cuh>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/questions/signed_distances.hpp>

#include "distances.hpp"

template clearance::point_distances robot_on_backend<clearance::device>::distances(poses_of, double, bool);
template std::vector<clearance::part_witness> robot_on_backend<clearance::device>::witnesses(
    poses_of, std::span<const clearance::part_minimum>);
