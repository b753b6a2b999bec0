// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The k nearest points of each part, on the host or on a device.

#include <clearance/collect_query.cuh>
#include <clearance/nearest_k.hpp>
