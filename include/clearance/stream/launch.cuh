// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The memory that the kernels of a prepared query share from frame to frame, and their launch.

#include <clearance/backend/device.cuh>
#include <clearance/stream/place_kernel.cuh>
#include <clearance/stream/stream_kernel.cuh>

#include <algorithm>
#include <memory>

namespace clearance::stream {

template <class PartView>
class launcher {
 public:
  using args = frame_args<PartView>;

  /// For `parts` trees, none deeper or wider than that.
  launcher(const device& on, std::size_t parts, std::uint32_t depth, std::uint32_t width, std::pmr::memory_resource* memory)
      : on_(on), parts_(std::uint32_t(parts)) {
    if (parts > most_parts)
      throw std::invalid_argument("clearance::min_distance_query: " + std::to_string(parts) + " parts, but at most " + std::to_string(most_parts) +
                                  " on a device; use min_distance");
    if (width > most_children || std::uint64_t(depth) * (width - 1) + 1 > deepest_stack)
      throw std::invalid_argument("clearance::min_distance_query: a tree of depth " + std::to_string(depth) + " and width " + std::to_string(width) +
                                  " is too large for a device; use min_distance");
    const auto ask = [&](cudaDeviceAttr what) {
      int value = 0;
      check_cuda(cudaDeviceGetAttribute(&value, what, on.id), "cudaDeviceGetAttribute");
      return unsigned(value);
    };
    processors_ = ask(cudaDevAttrMultiProcessorCount);
    shared_of_processor_ = ask(cudaDevAttrMaxSharedMemoryPerMultiprocessor);
    most_shared_ = ask(cudaDevAttrMaxSharedMemoryPerBlockOptin);
    state_ = device_buffer<frame_state>(1, on.id, memory);
    witnesses_ = device_buffer<typename args::witness_type>(most_parts, on.id, memory);
    records_ = device_buffer<record>(2 * processors_ * parts, on.id, memory);
    candidates_ = device_buffer<typename args::witness_type>(2 * processors_, on.id, memory);
    placed_ = device_buffer<placed_parts>(1, on.id, memory);
    const device_guard guard(on.id);
    check_cuda(cudaMemsetAsync(witnesses_.data(), 0, most_parts * sizeof(typename args::witness_type), on.stream), "cudaMemsetAsync");
    forget();
  }

  void forget() {
    const frame_state fresh;
    on_.stage(std::span(&fresh, 1), state_.data());
  }

  /// What all clouds of a frame have in common.
  args first(const PartView* views, min_distance_result* result, part_minimum* minima, std::uint32_t* done, std::uint32_t number) const {
    args a{};
    a.parts = parts_, a.views = views, a.state = state_.data(), a.witnesses = witnesses_.data(), a.records = records_.data(), a.candidates = candidates_.data();
    a.rest = placed_.data();
    a.result = result, a.minima = minima, a.done = done, a.number = number;
    return a;
  }

  /// Poses that the host has made ready: few travel with the launch, many beforehand.
  void put(std::span<const search::placement> places, args& a) {
    const auto fill = [&](auto& parts, world_transform* world) {
      for (std::uint32_t k = 0; k < parts_; ++k) parts.part[k] = frame_part(places[k]), world[k] = places[k].world_from_part;
      for (std::uint32_t c = 0; c * cluster < parts_; ++c) parts.gather(c, parts_);
    };
    a.far = parts_ > inline_parts;
    if (!a.far) return fill(a.near, a.world_from_part);
    if (!staged_) staged_ = std::make_unique<placed_parts>();
    fill(staged_->parts, staged_->world_from_part);
    const auto bytes = [](auto* from) { return reinterpret_cast<std::byte*>(from); };
    const std::span<const std::byte> parts(bytes(&staged_->parts), bytes(staged_->parts.part + parts_));
    on_.stage(parts, bytes(&placed_.data()->parts));
    on_.stage(std::span<const world_transform>(staged_->world_from_part, parts_), placed_.data()->world_from_part);
  }

  /// Poses in device or pinned memory, made ready there; `off` is the `rounding_of` the cloud's source.
  void place(const world_transform* poses, const world_transform* cloud, const position_error& off, args& a) {
    place_kernel<<<1, most_parts, 0, on_.stream>>>(poses, cloud, a.views, parts_, off, placed_.data());
    check_cuda(cudaGetLastError(), "kernel launch");
    a.far = a.placed = true;
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
    using memory = block_memory<PartView, Each>;
    const std::size_t shared = memory_bytes<PartView, Each>(a.parts);
    a.top_stride = a.parts == 0 ? 0 : std::min(memory::top_capacity / a.parts, 128u);
    // Every translation unit has a kernel of its own, so what is allowed is known by its address, and not by its type.
    const auto kernel = stream_kernel<PartView, Each, Source>;
    if (const auto address = reinterpret_cast<const void*>(kernel); std::find(allowed_.begin(), allowed_.end(), address) == allowed_.end()) {
      check_cuda(cudaFuncSetAttribute(address, cudaFuncAttributeMaxDynamicSharedMemorySize, int(most_shared_)), "cudaFuncSetAttribute");
      allowed_.push_back(address);
    }
    constexpr unsigned a_block = in_block_round;
    const unsigned resident = 2 * (shared + 1024) <= shared_of_processor_ ? processors_ * 2 : processors_;
    const unsigned blocks = std::max(1u, std::min(resident, (a.points + a_block - 1) / a_block));
    a.rounds = (a.points + a_block * blocks - 1) / (a_block * blocks);
    a.ahead = rounds_ahead(source, a.points, blocks);
    kernel<<<blocks, block_threads, shared, on_.stream>>>(source, a);
    check_cuda(cudaGetLastError(), "kernel launch");
  }

  device on_;
  std::uint32_t parts_;
  unsigned processors_ = 0, most_shared_ = 0, shared_of_processor_ = 0;
  device_buffer<frame_state> state_;
  device_buffer<typename args::witness_type> witnesses_;
  device_buffer<record> records_;
  device_buffer<typename args::witness_type> candidates_;
  device_buffer<placed_parts> placed_;
  std::vector<const void*> allowed_;  ///< Kernels whose limit of shared memory has been raised: that takes longer than a launch.
  std::unique_ptr<placed_parts> staged_;    ///< Of many parts, on their way to `placed_`.
};

}  // namespace clearance::stream
