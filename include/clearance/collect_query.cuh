// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Prepared questions about pairs, on the host or on a device.

#include <clearance/answer/kept_memory.cuh>
#include <clearance/collect.cuh>
#include <clearance/collect_query.hpp>
