// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/device.cuh>
#include <clearance/backend/kept_memory.hpp>

namespace clearance::backends {

/// On a device: from `memory`, a resource that hands out device memory, unless that is null.
template <>
class memory_of<device> {
 public:
  using piece = device_buffer<memory_unit>;

  explicit memory_of(const device& on, std::pmr::memory_resource* memory = nullptr) : on_(on), memory_(memory) {}

  piece take(std::size_t units) const { return {units, on_.id, memory_}; }

 private:
  device on_;
  std::pmr::memory_resource* memory_;
};

}  // namespace clearance::backends
