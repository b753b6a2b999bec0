// SPDX-License-Identifier: BSD-3-Clause
#include "own_traversal.hpp"

#include <clearance/device.cuh>

int main() { return example(clearance::device{.id = 0}); }
