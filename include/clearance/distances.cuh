// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every point's distance, on the host or on a device.

#include <clearance/answer/pointwise.cuh>
#include <clearance/backend/stream_resource.cuh>
#include <clearance/distances.hpp>

namespace clearance::pointwise {

template <>
struct points_on<device> {
  template <class PartView, class Clouds, class Here>
  static distance_certainty once(const device& on, const model_view<PartView>& model,
                                 std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                 const distances_out& out, real d_max, point_counts* counts, const Here& here) {
    stream_resource memory(on.id, on.stream);
    return device_points<PartView>(on, model, &memory).enqueue(poses, clouds, out, d_max, counts, here);
  }

  template <class PartView>
  struct kept : device_points<PartView> {
    kept(const device& on, const model_view<PartView>& model, std::pmr::memory_resource* memory = nullptr)
        : device_points<PartView>(on, model, memory, true) {}
  };
};

}  // namespace clearance::pointwise
