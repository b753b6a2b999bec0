// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/min_distance_query.cuh>  // the device's own query, one kernel a frame

#include "live_loop.hpp"

int main() { return example(clearance::device{.id = 0}); }
