// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The memory that the kernels of a prepared query share from frame to frame, and their launch.

#include <clearance/backend/device.cuh>
#include <clearance/stream/place_kernel.cuh>
#include <clearance/stream/stream_kernel.cuh>

#include <atomic>

namespace clearance::stream {

template <class PartView>
class launcher {
 public:
  using args = frame_args<PartView>;

  launcher(const device& on, std::size_t parts, std::pmr::memory_resource* memory) : on_(on), parts_(std::uint32_t(parts)) {
    if (parts > most_parts)
      throw std::invalid_argument("clearance::min_distance_query: " + std::to_string(parts) + " parts, but at most " + std::to_string(most_parts) +
                                  " on a device; use min_distance");
    const auto ask = [&](cudaDeviceAttr what) {
      int value = 0;
      check_cuda(cudaDeviceGetAttribute(&value, what, on.id), "cudaDeviceGetAttribute");
      return unsigned(value);
    };
    most_blocks_ = ask(cudaDevAttrMultiProcessorCount) * 2;
    most_shared_ = ask(cudaDevAttrMaxSharedMemoryPerBlockOptin);
    state_ = device_buffer<frame_state>(1, on.id, memory);
    records_ = device_buffer<record>(most_blocks_ * parts, on.id, memory);
    placed_ = device_buffer<placed_parts<PartView>>(1, on.id, memory);
    forget();
  }

  void forget() {
    const frame_state fresh;
    on_.stage(std::span(&fresh, 1), state_.data());
  }

  /// What all clouds of a frame have in common.
  args first(min_distance_result* result, part_minimum* minima, std::uint32_t* done, std::uint32_t number) const {
    args a{};
    a.parts = parts_, a.state = state_.data(), a.records = records_.data();
    a.result = result, a.minima = minima, a.done = done, a.number = number;
    return a;
  }

  void put(std::span<const stream_part<PartView>> parts, args& a) {
    const std::size_t inside = std::min<std::size_t>(parts.size(), inline_parts);
    std::copy_n(parts.begin(), inside, a.part);
    a.more = placed_.data()->part;
    on_.stage(parts.subspan(inside), placed_.data()->part);
  }

  const placed_parts<PartView>* place(const world_transform* poses, const world_transform* cloud, const stream_part<PartView>* parts) {
    place_kernel<<<1, most_parts, 0, on_.stream>>>(poses, cloud, parts, parts_, placed_.data());
    check_cuda(cudaGetLastError(), "kernel launch");
    return placed_.data();
  }

  std::uint32_t checked(std::uint64_t points) const {
    if (points >= none - block_threads * 4 * most_blocks_)
      throw std::invalid_argument("clearance::min_distance_query: " + std::to_string(points) + " points are too many for one call");
    return std::uint32_t(points);
  }

  template <class Source>
  void operator()(const Source& source, args& a) const {
    if (a.minima == nullptr)
      start<false>(source, a);
    else
      start<true>(source, a);
  }

 private:
  template <bool Each, class Source>
  void start(const Source& source, args& a) const {
    a.ring = shared_bytes<PartView, Each, Source>(true) <= most_shared_;
    const std::size_t shared = shared_bytes<PartView, Each, Source>(a.ring);
    static std::atomic<std::uint64_t> allowed{0};  // by device: a kernel's limit is raised once, as that takes longer than a launch
    const std::uint64_t bit = 1ull << (on_.id & 63);
    if ((allowed.load(std::memory_order_relaxed) & bit) == 0) {
      check_cuda(cudaFuncSetAttribute(stream_kernel<PartView, Each, Source>, cudaFuncAttributeMaxDynamicSharedMemorySize, int(shared)),
                 "cudaFuncSetAttribute");
      allowed.fetch_or(bit, std::memory_order_relaxed);
    }
    constexpr unsigned a_block = block_threads * quad;
    const unsigned blocks = std::max(1u, std::min(most_blocks_, (a.points + a_block - 1) / a_block));
    stream_kernel<PartView, Each><<<blocks, block_threads, shared, on_.stream>>>(source, a);
    check_cuda(cudaGetLastError(), "kernel launch");
  }

  device on_;
  std::uint32_t parts_;
  unsigned most_blocks_ = 0, most_shared_ = 0;
  device_buffer<frame_state> state_;
  device_buffer<record> records_;
  device_buffer<placed_parts<PartView>> placed_;
};

}  // namespace clearance::stream
