// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/device.cuh>

#include "cell.hpp"

int main() { return example(clearance::device{}); }
