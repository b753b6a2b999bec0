// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where every part's least distance is, on the host or on a device.

#include <clearance/answer/kept_memory.cuh>
#include <clearance/part_witnesses.hpp>
