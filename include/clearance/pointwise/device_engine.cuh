// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/kept_memory.cuh>
#include <clearance/frame/readable.cuh>
#include <clearance/pointwise/device_points.cuh>
#include <clearance/pointwise/engine.hpp>

namespace clearance::pointwise {

/// On a device: the kernel of packets, which remembers the primitive nearest to each point.
template <>
struct points_on<device> {
  template <class PartView>
  struct kept : device_points<PartView> {
    kept(const device& on, const model_view<PartView>& model, std::pmr::memory_resource* memory = nullptr)
        : device_points<PartView>(on, model, memory, true) {}
  };
};

}  // namespace clearance::pointwise
