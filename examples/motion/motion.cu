// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/motion_clearance.cuh>  // a device's scan

#include "motion.hpp"

int main() { return example(clearance::device{}); }
