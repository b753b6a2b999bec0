// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/questions/distances.hpp>
#include <clearance/device.cuh>
#include <clearance/questions/distances_per_part.hpp>

#include "distances.hpp"

int main() { return example(clearance::device{}); }
