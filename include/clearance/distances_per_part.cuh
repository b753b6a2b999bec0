// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every point's distance to every part, on the host or on a device.

#include <clearance/collect_query.cuh>
#include <clearance/distances_per_part.hpp>
