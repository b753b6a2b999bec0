// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/self_filter.cuh>  // a device's scan

#include "self_filter.hpp"

int main() { return example(clearance::device{}); }
