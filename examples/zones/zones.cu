// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/zones.cuh>  // a device's scan

#include "zones.hpp"

int main() { return example(clearance::device{}); }
