// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the order of a tree's points takes of CUB. It is apart, because CUB takes seconds to read and only questions
// about plans need it.

#include <clearance/cloud_tree/device_tree.cuh>

#include <cub/block/block_merge_sort.cuh>
#include <cub/device/device_scan.cuh>

namespace clearance::cloud_tree {

template <>
struct device_sort<std::uint64_t> {
  /// Replaces each of `n` counts by the sum of those before it. With `room` null it only says how many bytes it needs.
  static void sums(void* room, std::size_t& bytes, std::uint32_t* counts, std::size_t n, cudaStream_t stream) {
    check_cuda(cub::DeviceScan::ExclusiveSum(room, bytes, counts, counts, n, stream), "cub::DeviceScan::ExclusiveSum");
  }
  /// Sorts the keys of a block of `Threads` threads.
  template <int Threads>
  __device__ static std::uint64_t of_block(std::uint64_t key) {
    using sort = cub::BlockMergeSort<std::uint64_t, Threads, 1>;
    __shared__ typename sort::TempStorage room;
    std::uint64_t keys[1] = {key};
    sort(room).Sort(keys, [](std::uint64_t a, std::uint64_t b) { return a < b; });
    return keys[0];
  }
};

}  // namespace clearance::cloud_tree
