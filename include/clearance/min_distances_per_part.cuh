// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distances of each part of many configurations, on the host or on a device.

#include <clearance/answer/kept_memory.cuh>
#include <clearance/min_distances.cuh>
#include <clearance/min_distances_per_part.hpp>
