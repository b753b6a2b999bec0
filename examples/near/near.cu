// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/in_collision.cuh>  // a device's scan
#include <clearance/within.cuh>

#include "near.hpp"

int main() { return example(clearance::device{}); }
