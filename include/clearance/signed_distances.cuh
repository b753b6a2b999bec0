// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every point's distance from closed meshes and depth in them, on the host or on a device.

#include <clearance/distances.cuh>
#include <clearance/signed_distances.hpp>
