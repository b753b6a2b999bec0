// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance that several points confirm, on the host or on a device.

#include <clearance/min_support.hpp>
#include <clearance/nearest_k.cuh>
