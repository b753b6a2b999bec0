// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The memory that the kernels of a prepared query share from frame to frame, and their launch.

#include <clearance/backend/device.cuh>
#include <clearance/stream/place_kernel.cuh>
#include <clearance/stream/stream_kernel.cuh>

#include <algorithm>

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
    processors_ = ask(cudaDevAttrMultiProcessorCount);
    shared_of_processor_ = ask(cudaDevAttrMaxSharedMemoryPerMultiprocessor);
    most_shared_ = ask(cudaDevAttrMaxSharedMemoryPerBlockOptin);
    state_ = device_buffer<frame_state>(1, on.id, memory);
    records_ = device_buffer<record>(2 * processors_ * parts, on.id, memory);
    placed_ = device_buffer<placed_parts>(1, on.id, memory);
    forget();
  }

  void forget() {
    const frame_state fresh;
    on_.stage(std::span(&fresh, 1), state_.data());
  }

  /// What all clouds of a frame have in common.
  args first(const PartView* views, min_distance_result* result, part_minimum* minima, std::uint32_t* done, std::uint32_t number) const {
    args a{};
    a.parts = parts_, a.views = views, a.state = state_.data(), a.records = records_.data(), a.rest = placed_.data();
    a.result = result, a.minima = minima, a.done = done, a.number = number;
    return a;
  }

  /// Poses that the host has made ready: some travel with the launch, and the rest beforehand.
  void put(std::span<const search::placement> places, args& a) {
    parts_now_.clear();
    for (const auto& p : places) parts_now_.emplace_back(p);
    for (std::size_t k = 0; k < places.size(); k += cluster) gather(&parts_now_[k], std::uint32_t(std::min<std::size_t>(cluster, places.size() - k)));
    const std::size_t inside = std::min<std::size_t>(places.size(), inline_parts);
    std::copy_n(parts_now_.begin(), inside, a.part);
    for (std::size_t k = 0; k < inside; ++k) a.world_from_part[k] = places[k].world_from_part;
    if (places.size() == inside) return;
    world_now_.clear();
    for (const auto& p : places) world_now_.push_back(p.world_from_part);
    on_.stage(std::span<const frame_part>(parts_now_), placed_.data()->part);
    on_.stage(std::span<const world_transform>(world_now_), placed_.data()->world_from_part);
  }

  /// Poses in device or pinned memory, made ready there.
  void place(const world_transform* poses, const world_transform* cloud, args& a) {
    place_kernel<<<1, most_parts, 0, on_.stream>>>(poses, cloud, a.views, parts_, placed_.data());
    check_cuda(cudaGetLastError(), "kernel launch");
    a.placed = true;
  }

  std::uint32_t checked(std::uint64_t points) const {
    if (points >= none - block_threads * 8 * processors_)
      throw std::invalid_argument("clearance::min_distance_query: " + std::to_string(points) + " points are too many for one call");
    return std::uint32_t(points);
  }

  template <class Source>
  void operator()(const Source& source, args& a) {
    if (a.minima == nullptr)
      start<false>(source, a);
    else
      start<true>(source, a);
  }

 private:
  template <bool Each, class Source>
  void start(const Source& source, args& a) {
    constexpr std::size_t ring = ring_bytes<Source>();
    const std::size_t others = sizeof(block_memory<PartView, Each>) + a.parts * sizeof(block_part<PartView>);
    a.ring = others + ring <= most_shared_;
    const std::size_t shared = others + (a.ring ? ring : 0);
    // Every translation unit has a kernel of its own, so what is allowed is known by its address, and not by its type.
    const auto kernel = stream_kernel<PartView, Each, Source>;
    if (const auto address = reinterpret_cast<const void*>(kernel); std::find(allowed_.begin(), allowed_.end(), address) == allowed_.end()) {
      check_cuda(cudaFuncSetAttribute(address, cudaFuncAttributeMaxDynamicSharedMemorySize, int(most_shared_)), "cudaFuncSetAttribute");
      allowed_.push_back(address);
    }
    constexpr unsigned a_block = block_threads * quad;
    const unsigned resident = 2 * (shared + 1024) <= shared_of_processor_ ? processors_ * 2 : processors_;
    const unsigned blocks = std::max(1u, std::min(resident, (a.points + a_block - 1) / a_block));
    kernel<<<blocks, block_threads, shared, on_.stream>>>(source, a);
    check_cuda(cudaGetLastError(), "kernel launch");
  }

  device on_;
  std::uint32_t parts_;
  unsigned processors_ = 0, most_shared_ = 0, shared_of_processor_ = 0;
  device_buffer<frame_state> state_;
  device_buffer<record> records_;
  device_buffer<placed_parts> placed_;
  std::vector<const void*> allowed_;  ///< Kernels whose limit of shared memory has been raised: that takes longer than a launch.
  std::vector<frame_part> parts_now_;
  std::vector<world_transform> world_now_;
};

}  // namespace clearance::stream
