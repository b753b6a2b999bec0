// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from everything that its sensors see? On the host or on a device.

#include <clearance/answer/device_search.cuh>
#include <clearance/backend/stream_resource.cuh>
#include <clearance/min_distance.hpp>

namespace clearance::minimum {

/// On a device: the kernel of a scan, with memory for one call from its stream.
template <>
struct search_on<device> {
  static const device& backend_of(const device& on) { return on; }
  template <bool PerPart, class PartView, class Clouds, class Here>
  static void once(const device& on, const model_view<PartView>& model, std::span<const Eigen::Isometry3d> poses,
                   const Clouds& clouds, min_distance_result* result, part_minimum* minima, const Here& here) {
    stream_resource memory(on.id, on.stream);
    device_search<PartView>(on, model, &memory).template enqueue<PerPart>(poses, clouds, result, minima, here);
  }
};

}  // namespace clearance::minimum
