// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/questions/min_distance.hpp>
#include <clearance/device.cuh>

#include "prepared.hpp"

int main() { return example(clearance::device{.id = 0}); }
