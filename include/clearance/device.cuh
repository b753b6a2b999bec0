// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Gives every question a device: include it beside the questions, in sources that nvcc compiles. What only some
// questions need of a device they include themselves, because nvcc reads every header twice.

#include <clearance/backends/one_call.cuh>
#include <clearance/minimum/device_engine.cuh>
#include <clearance/minimum/warp_walk.cuh>
#include <clearance/pairwise/device_pairs.cuh>
#include <clearance/query/on_devices.cuh>

namespace clearance::detail {

template <>
inline constexpr bool has_scan<device> = true;
template <>
inline constexpr bool has_scan<devices> = true;
template <class Traversal>
inline constexpr bool has_scan<plain<device, Traversal>> = true;

}  // namespace clearance::detail
