// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How close does a robot come to the points while it moves? On the host or on a device.

#include <clearance/min_distance_query.cuh>
#include <clearance/motion_clearance.hpp>
