// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/compacted.cuh>  // how a device does it
#include <clearance/device.cuh>

#include "self_filter.hpp"

int main() { return example(clearance::device{}); }
