// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Questions of one's own, on the host or on a device.

#include <clearance/answer/pairwise.cuh>
#include <clearance/backend/stream_resource.cuh>
#include <clearance/collect.hpp>

namespace clearance::pairwise {

template <>
struct pairs_on<device> {
  static constexpr bool meets_points = true;
  template <class PartView>
  using kept = device_pairs<PartView>;

  template <class PartView, class Clouds, answer Answer, class Here>
  static void once(const device& on, const model_view<PartView>& model, std::span<const Eigen::Isometry3d> poses,
                   const Clouds& clouds, const Answer& answer, point_counts* counts, const Here& here) {
    stream_resource memory(on.id, on.stream);
    device_pairs<PartView>(on, model, &memory).enqueue(poses, clouds, answer, counts, here);
  }
};

}  // namespace clearance::pairwise
