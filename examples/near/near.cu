// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/questions/in_collision.hpp>
#include <clearance/device.cuh>
#include <clearance/questions/within.hpp>

#include "near.hpp"

int main() { return example(clearance::device{}); }
