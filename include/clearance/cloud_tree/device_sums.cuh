// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the order of a tree's points takes of CUB: sums of counts. It is apart, because CUB takes seconds to read and
// only questions about plans need it.

#include <clearance/cloud_tree/device_tree.cuh>

#include <cub/device/device_scan.cuh>

namespace clearance::cloud_tree {

template <>
struct device_sums<std::uint32_t> {
  /// Replaces each of `n` counts by the sum of those before it. With `room` null it only says how many bytes it needs.
  static void exclusive(void* room, std::size_t& bytes, std::uint32_t* counts, std::size_t n, cudaStream_t stream) {
    check_cuda(cub::DeviceScan::ExclusiveSum(room, bytes, counts, counts, n, stream), "cub::DeviceScan::ExclusiveSum");
  }
};

}  // namespace clearance::cloud_tree
