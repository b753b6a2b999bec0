// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/distances.cuh>  // a device's scan
#include <clearance/distances_per_part.cuh>

#include "distances.hpp"

int main() { return example(clearance::device{}); }
