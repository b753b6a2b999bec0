// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/min_distance.cuh>  // a device's scans
#include <clearance/part_witnesses.cuh>
#include <clearance/zones.cuh>

#include "zones.hpp"

int main() { return example(clearance::device{}); }
