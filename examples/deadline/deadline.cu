// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/min_distance_by.cuh>  // a device's scan

#include "deadline.hpp"

int main() { return example(clearance::device{}); }
