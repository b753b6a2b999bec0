// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Memory that a prepared question keeps, of the host or of a device.

#include <clearance/answer/kept_copies.cuh>
#include <clearance/answer/kept_memory.hpp>
#include <clearance/backend/one_call.cuh>

namespace clearance::pairwise {

/// On a device: from `memory`, a resource that hands out device memory, unless that is null.
template <>
class memory_on<device> {
 public:
  using piece = device_buffer<memory_unit>;

  /// Not private: its name becomes part of a kernel's.
  struct to_copies {
    minimum::kept_copies* copies;
    std::uint32_t cloud = 0;

    template <point_source S>
    S operator()(const S& source) {
      return (*copies)(source, cloud++);
    }
  };

  explicit memory_on(const device& on, std::pmr::memory_resource* memory = nullptr)
      : on_(on), memory_(memory), copies_(on, memory) {}

  piece take(std::size_t units) const { return {units, on_.id, memory_}; }

  template <class Clouds>
  auto readable(const Clouds& clouds) {
    return mapped_clouds(clouds, to_copies{&copies_});
  }

 private:
  device on_;
  std::pmr::memory_resource* memory_;
  minimum::kept_copies copies_;
};

}  // namespace clearance::pairwise
