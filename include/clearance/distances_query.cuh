// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The prepared question of every point's distance, on the host or on a device.

#include <clearance/distances.cuh>
#include <clearance/distances_query.hpp>
