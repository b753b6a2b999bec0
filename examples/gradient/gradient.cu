// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/questions/min_distance.hpp>
#include <clearance/device.cuh>
#include <clearance/questions/part_witnesses.hpp>

#include "gradient.hpp"

int main() { return example(clearance::device{}); }
