// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/in_collisions.cuh>  // a device's search
#include <clearance/min_distances_per_part.cuh>

#include "plan.hpp"

int main() { return example(clearance::device{}); }
