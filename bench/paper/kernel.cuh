// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The paper's kernel, one thread (or group of lanes) per point, and its launches: parts one after another, one stream
// per part, or all in one kernel: in a thread's loop ("fused"), or in a grid of parts x points.

#include "policies.cuh"

#include <clearance/backends/device.cuh>
#include <clearance/frames/frame.hpp>

#include <array>

namespace bench::paper {

using clearance::check_cuda;

/// What the kernels of a frame receive.
template <class View>
struct parts_at {
  static constexpr unsigned most = 16;
  part_at<View> part[most];
  unsigned count = 0;
  clearance::vec3 origin;
};

template <class Sharing, class Walk, class Transform, bool Count, class View, clearance::point_source Source>
__global__ void paper_kernel(const __grid_constant__ parts_at<View> parts, unsigned begin, unsigned end,
                             const Source cloud, std::size_t stride, std::uint32_t* bound, counts* all) {
  constexpr bool by_block = std::is_same_v<Sharing, shared_by_block>,
                 by_nobody = std::is_same_v<Sharing, shared_by_nobody>;
  [[maybe_unused]] __shared__ std::uint32_t of_block;
  if constexpr (by_block) {
    if (threadIdx.x == 0) of_block = clearance::ordered(clearance::infinity);
    __syncthreads();
  }
  if (gridDim.y > 1) begin += blockIdx.y, end = begin + 1;  // a grid of parts x points
  const std::size_t all_lanes = gridDim.x * std::size_t(blockDim.x);
  const std::size_t first = blockIdx.x * std::size_t(blockDim.x) + threadIdx.x;
  for (std::size_t i = first / lanes_of<Walk>() * stride; i < cloud.size();
       i += all_lanes / lanes_of<Walk>() * stride) {
    const clearance::sample s = cloud[i];
    if (!s.valid()) continue;
    const clearance::vec3 p = s.position - parts.origin;
    auto ask = [&] {
      if constexpr (by_nobody)
        return own_bound{};
      else
        return word_bound{by_block ? &of_block : bound};
    }();
    [[maybe_unused]] unsigned tests = 0, leaves = 0;
    for (unsigned k = begin; k < end; ++k)
      Transform::meet(parts.part[k], p, ask.reach(), [&](const auto& tree, clearance::vec3 q) {
        if constexpr (Count)
          Walk{}(counted(tree, &tests, &leaves), q, ask);
        else
          Walk{}(tree, q, ask);
      });
    if constexpr (Count) {
      atomicAdd(&all->tests, tests), atomicAdd(&all->leaves, leaves), atomicAdd(&all->accepted, ask.accepted);
    }
    if constexpr (by_nobody) atomicMin(bound, clearance::ordered(ask.best));
  }
  if constexpr (by_block) {
    __syncthreads();
    if (threadIdx.x == 0) atomicMin(bound, of_block);
  }
}

enum class schedule { sequential, streams, fused, grid };

/// CUDA streams, one per part. They start after the work on the main one (the default stream), which waits for them.
class part_streams {
 public:
  part_streams() {
    for (auto& s : streams_) check_cuda(cudaStreamCreateWithFlags(&s, cudaStreamNonBlocking), "cudaStreamCreate");
    for (auto& e : done_) check_cuda(cudaEventCreateWithFlags(&e, cudaEventDisableTiming), "cudaEventCreate");
    check_cuda(cudaEventCreateWithFlags(&start_, cudaEventDisableTiming), "cudaEventCreate");
  }
  part_streams(const part_streams&) = delete;
  part_streams& operator=(const part_streams&) = delete;
  ~part_streams() {
    for (auto s : streams_) cudaStreamDestroy(s);
    for (auto e : done_) cudaEventDestroy(e);
    cudaEventDestroy(start_);
  }

  /// Calls `work(k, stream)` for each part.
  template <class F>
  void fork(unsigned count, F work) const {
    check_cuda(cudaEventRecord(start_, nullptr), "cudaEventRecord");
    for (unsigned k = 0; k < count; ++k) {
      check_cuda(cudaStreamWaitEvent(streams_[k], start_), "cudaStreamWaitEvent");
      work(k, streams_[k]);
      check_cuda(cudaEventRecord(done_[k], streams_[k]), "cudaEventRecord");
    }
    for (unsigned k = 0; k < count; ++k) check_cuda(cudaStreamWaitEvent(nullptr, done_[k]), "cudaStreamWaitEvent");
  }

 private:
  std::array<cudaStream_t, 16> streams_;
  std::array<cudaEvent_t, 16> done_;
  cudaEvent_t start_;
};

/// A point of the design space: compiled axes as types, the others as values.
template <class Sharing, class Walk, class Transform = points_into_parts, bool Count = false>
struct method {
  schedule order = schedule::streams;
  unsigned threads = 128;
  unsigned most_blocks = 0x7fffffff;  ///< If fewer than points need, blocks stay, and a thread takes several points.

  template <class View, class Source>
  static auto kernel() {
    return paper_kernel<Sharing, Walk, Transform, Count, View, Source>;
  }

  /// One kernel over parts begin .. end-1 and every `stride`-th point; in a grid, each row has one of the parts.
  template <class View, class Source>
  void launch(const parts_at<View>& parts, unsigned begin, unsigned end, const Source& cloud, std::uint32_t* bound,
              counts* all, cudaStream_t on, std::size_t stride = 1, unsigned rows = 1) const {
    const std::size_t n = (cloud.size() + stride - 1) / stride * lanes_of<Walk>();
    std::size_t shared = 0;
    if constexpr (lanes_of<Walk>() > 1) shared = Walk::shared_bytes(threads);
    if (n == 0) return;
    const unsigned blocks = unsigned(std::min<std::size_t>((n + threads - 1) / threads, most_blocks));
    kernel<View, Source>()<<<dim3(blocks, rows), threads, shared, on>>>(parts, begin, end, cloud, stride, bound, all);
    check_cuda(cudaGetLastError(), "kernel launch");
  }

  /// Everything for a frame, in the order of the default stream.
  template <class View, class Source>
  void enqueue(const part_streams& streams, const parts_at<View>& parts, const Source& cloud, std::uint32_t* bound,
               counts* all) const {
    if (order == schedule::fused) return launch(parts, 0, parts.count, cloud, bound, all, nullptr);
    if (order == schedule::grid) return launch(parts, 0, parts.count, cloud, bound, all, nullptr, 1, parts.count);
    if (order == schedule::streams)
      return streams.fork(parts.count,
                          [&](unsigned k, cudaStream_t on) { launch(parts, k, k + 1, cloud, bound, all, on); });
    for (unsigned k = 0; k < parts.count; ++k) launch(parts, k, k + 1, cloud, bound, all, nullptr);
  }
};

}  // namespace bench::paper
