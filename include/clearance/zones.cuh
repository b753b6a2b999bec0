// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Zones around parts, on the host or on a device.

#include <clearance/collect_query.cuh>
#include <clearance/zones.hpp>
