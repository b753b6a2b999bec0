// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/min_distances.cuh>  // a device's search

#include "plan.hpp"

int main() { return example(clearance::device{}); }
