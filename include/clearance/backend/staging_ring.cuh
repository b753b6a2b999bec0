// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/own_stream.cuh>
#include <clearance/backend/pinned_buffer.cuh>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <span>

namespace clearance {

/// Brings bytes to a device through three rooms in turn: while one is filled, another is copied, and a third is read on
/// the device. In each turn call `fill` and `copy`, enqueue what reads the bytes in the device's stream, and call
/// `read`. Bytes in pinned memory are copied from where they lie.
class staging_ring {
 public:
  static constexpr std::size_t rooms = 3;

  explicit staging_ring(const device& on) : on_(on), copies_(on.id) {
    for (room& r : rooms_) r.copied = own_event(on.id), r.read = own_event(on.id);
  }

  /// Call it before the first turn, with the largest sizes of any turn, in bytes, on either side.
  void need(std::size_t pinned, std::size_t there) {
    // Every room is checked: some have no memory if an allocation once failed.
    if (std::ranges::all_of(rooms_,
                            [&](const room& r) { return pinned <= r.pinned.size() && there <= r.there.size(); }))
      return;
    wait();
    for (room& r : rooms_) {
      if (r.pinned.size() < pinned) r.pinned = {}, r.pinned = pinned_buffer<std::byte>(pinned, on_.id);
      if (r.there.size() < there) r.there = {}, r.there = device_buffer<std::byte>(there, on_.id);
    }
  }

  /// Returns the pinned memory of turn k, after its old content has been copied.
  std::byte* fill(std::size_t k) {
    room& r = rooms_[k % rooms];
    const device_guard guard(on_.id);
    check_cuda(cudaEventSynchronize(r.copied.get()), "cudaEventSynchronize");
    return r.pinned.data();
  }
  /// Enqueues the copy of `bytes`, which the device's stream waits for. Returns where they will be.
  const std::byte* copy(std::size_t k, std::span<const std::byte> bytes) {
    room& r = rooms_[k % rooms];
    const device_guard guard(on_.id);
    const std::byte* from = bytes.data();
    if (!within(r.pinned, from) && !is_pinned(from)) {
      constexpr std::size_t grain = std::size_t(1)
                                    << 16;  // one thread is slower than the link; all threads share short chunks, too
      need_within(bytes.size(), r);
      tbb::parallel_for(
          std::size_t(0), (bytes.size() + grain - 1) / grain,
          [&](std::size_t i) {
            std::memcpy(r.pinned.data() + i * grain, from + i * grain, std::min(grain, bytes.size() - i * grain));
          },
          tbb::simple_partitioner{});
      from = r.pinned.data();
    }
    const cudaStream_t stream = copies_.on().stream;
    check_cuda(cudaStreamWaitEvent(stream, r.read.get()), "cudaStreamWaitEvent");
    check_cuda(cudaMemcpyAsync(r.there.data(), from, bytes.size(), cudaMemcpyDefault, stream), "cudaMemcpyAsync");
    check_cuda(cudaEventRecord(r.copied.get(), stream), "cudaEventRecord");
    check_cuda(cudaStreamWaitEvent(on_.stream, r.copied.get()), "cudaStreamWaitEvent");
    return r.there.data();
  }
  /// Marks that everything that reads turn k is now in the device's stream.
  void read(std::size_t k) {
    const device_guard guard(on_.id);
    check_cuda(cudaEventRecord(rooms_[k % rooms].read.get(), on_.stream), "cudaEventRecord");
  }

  void wait() const { copies_.on().wait(), on_.wait(); }

 private:
  struct room {
    pinned_buffer<std::byte> pinned;
    device_buffer<std::byte> there;
    own_event copied, read;
  };

  static bool within(const pinned_buffer<std::byte>& memory, const std::byte* p) {
    return memory.size() != 0 && std::less_equal<>()(memory.data(), p) &&
           std::less<>()(p, memory.data() + memory.size());
  }
  static bool is_pinned(const void* memory) {
    cudaPointerAttributes attributes{};
    check_cuda(cudaPointerGetAttributes(&attributes, memory), "cudaPointerGetAttributes");
    return attributes.type != cudaMemoryTypeUnregistered;
  }
  void need_within(std::size_t bytes, room& r) const {
    if (r.pinned.size() < bytes) r.pinned = {}, r.pinned = pinned_buffer<std::byte>(r.there.size(), on_.id);
  }

  device on_;
  own_stream copies_;
  std::array<room, rooms> rooms_;
};

}  // namespace clearance
