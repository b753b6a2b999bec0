// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/device.cuh>

#include "unseen.hpp"

int main() { return example(clearance::device{}); }
