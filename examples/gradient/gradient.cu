// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/min_distance.cuh>  // a device's scan

#include "gradient.hpp"

int main() { return example(clearance::device{}); }
