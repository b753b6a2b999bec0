// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/device.cuh>

#include "plan.hpp"

int main() { return example(clearance::device{}); }
