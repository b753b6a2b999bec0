// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/device.cuh>

#include "own_answer.hpp"

int main() { return example(clearance::device{}); }
