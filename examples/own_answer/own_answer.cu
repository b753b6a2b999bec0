// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/collect.cuh>  // a device's scan

#include "own_answer.hpp"

int main() { return example(clearance::device{}); }
