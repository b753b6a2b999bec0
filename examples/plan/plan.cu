// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/questions/in_collisions.hpp>
#include <clearance/device.cuh>
#include <clearance/questions/min_distances_per_part.hpp>

#include "plan.hpp"

int main() { return example(clearance::device{}); }
