// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Is any point closer than a margin? On the host or on a device.

#include <clearance/collect_query.cuh>
#include <clearance/in_collision.hpp>
