// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The sort of a tree over points. It is apart, because CUB takes seconds to read and only questions about plans need
// it.

#include <clearance/cloud_tree/device_tree.cuh>

#include <cub/device/device_radix_sort.cuh>

namespace clearance::cloud_tree {

/// Sorts `n` pairs by bits `first` to `last - 1` of their keys. With `room` null it only says how many bytes it needs.
template <>
struct device_sort<std::uint32_t> {
  static void pairs(void* room, std::size_t& bytes, const std::uint32_t* keys, std::uint32_t* sorted_keys,
                    const std::uint32_t* values, std::uint32_t* sorted_values, std::size_t n, int first, int last,
                    cudaStream_t stream) {
    check_cuda(
        cub::DeviceRadixSort::SortPairs(room, bytes, keys, sorted_keys, values, sorted_values, n, first, last, stream),
        "cub::DeviceRadixSort::SortPairs");
  }
};

}  // namespace clearance::cloud_tree
