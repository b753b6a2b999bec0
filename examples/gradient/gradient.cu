// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/min_distance.cuh>  // a device's scan
#include <clearance/part_witnesses.cuh>

#include "gradient.hpp"

int main() { return example(clearance::device{}); }
