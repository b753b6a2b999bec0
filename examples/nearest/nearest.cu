// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/min_support.cuh>  // a device's scan

#include "nearest.hpp"

int main() { return example(clearance::device{}); }
