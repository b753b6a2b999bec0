// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points within a distance of parts, on the host or on a device.

#include <clearance/collect_query.cuh>
#include <clearance/within.hpp>
