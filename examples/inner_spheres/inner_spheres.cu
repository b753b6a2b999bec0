// SPDX-License-Identifier: BSD-3-Clause
#include "inner_spheres.hpp"

#include <clearance/min_distance.cuh>

int main() { return example(clearance::device{.id = 0}); }
