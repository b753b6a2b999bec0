// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points are the robot itself, and how far is the rest? On the host or on a device.

#include <clearance/collect_query.cuh>
#include <clearance/min_distance.cuh>
#include <clearance/self_filter.hpp>
