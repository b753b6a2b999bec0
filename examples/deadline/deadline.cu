// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/deadline.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/device.cuh>

#include "deadline.hpp"

int main() { return example(clearance::device{}); }
