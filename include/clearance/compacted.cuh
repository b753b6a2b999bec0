// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The valid points of a cloud, and nothing else, on the host or on a device.

#include <clearance/backends/device.cuh>
#include <clearance/backends/readback.cuh>
#include <clearance/compacted.hpp>

#include <thrust/iterator/counting_iterator.h>
#include <cub/device/device_select.cuh>

namespace clearance::detail {

template <point_source S>
struct is_valid {
  S source;
  __device__ bool operator()(std::uint32_t i) const { return source[i].valid(); }
};

template <point_source S>
struct gather_body {
  S source;
  vec3* points;
  const std::uint32_t *numbers, *count;

  CLEARANCE_HD void operator()(std::size_t i) const {
    if (i < *count) points[i] = source[numbers[i]].position;
  }
};

template <>
struct compacts_on<device> {
  template <point_source S>
  static void enqueue(const device& on, const S& source, vec3* points, std::uint32_t* numbers, std::uint32_t* count) {
    const device_guard guard(on.id);
    const auto select = [&](void* room, std::size_t& bytes) {
      check_cuda(cub::DeviceSelect::If(room, bytes, thrust::counting_iterator<std::uint32_t>(0), numbers, count,
                                       int(source.size()), is_valid<S>{source}, on.stream),
                 "cub::DeviceSelect::If");
    };
    std::size_t bytes = 0;
    select(nullptr, bytes);
    auto room = on.make_scratch<std::byte>(bytes);
    select(room.data(), bytes);
    on.for_each(source.size(), gather_body<S>{source, points, numbers, count});
  }
};

}  // namespace clearance::detail
