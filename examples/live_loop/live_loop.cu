// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/device.cuh>

#include "live_loop.hpp"

int main() { return example(clearance::device{.id = 0}); }
