// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance from a cloud in chunks on a device, which searches one chunk while the next is copied.

#include <clearance/backends/device.cuh>
#include <clearance/backends/device_buffer.cuh>
#include <clearance/backends/own_stream.cuh>
#include <clearance/minimum/chunked_search.hpp>
#include <clearance/minimum/device_engine.cuh>
#include <clearance/scan/boxes.hpp>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <span>

namespace clearance::scan {

// Boxes around neighbouring points of a cloud on a device, one block per piece.

inline constexpr unsigned boxing_threads = 256;

template <class S>
__global__ void __launch_bounds__(boxing_threads) box_pieces(const __grid_constant__ S source, boxed_piece* pieces) {
  constexpr unsigned warps = boxing_threads / 32, words = sizeof(boxed_piece) / 4;
  static_assert(sizeof(boxed_piece) == 4 * words && std::is_trivially_copyable_v<boxed_piece>);
  const auto others = [](const boxed_piece& mine, unsigned step) {
    boxed_piece other;
    const auto* from = reinterpret_cast<const unsigned*>(&mine);
    auto* to = reinterpret_cast<unsigned*>(&other);
#pragma unroll
    for (unsigned w = 0; w < words; ++w) to[w] = __shfl_xor_sync(~0u, from[w], step);
    return other;
  };
  const std::size_t begin = blockIdx.x * piece_points, all = source.size(),
                    end = all - begin < piece_points ? all : begin + piece_points;
  boxed_piece mine;
  for (std::size_t i = begin + threadIdx.x; i < end; i += boxing_threads) mine.add(source, i);
  for (unsigned step = 16; step != 0; step /= 2) {
    const boxed_piece other = others(mine, step);
    mine.add(other);
  }
  __shared__ unsigned of_warp[warps][words];
  if (threadIdx.x % 32 == 0) memcpy(of_warp[threadIdx.x / 32], &mine, sizeof mine);
  __syncthreads();
  if (threadIdx.x != 0) return;
  for (unsigned w = 1; w < warps; ++w) {
    boxed_piece other;
    memcpy(&other, of_warp[w], sizeof other);
    mine.add(other);
  }
  pieces[blockIdx.x] = mine;
}

/// Enqueues it. Writes `pieces` on the device: one per `piece_points` of the source.
template <point_source S>
void enqueue_boxes(const device& on, const S& source, boxed_piece* pieces) {
  if (source.size() != 0)
    on.launch(box_pieces<S>, unsigned((source.size() + piece_points - 1) / piece_points), boxing_threads, 0, source,
              pieces);
}

}  // namespace clearance::scan

namespace clearance {

/// Brings bytes to a device through three rooms in turn: while one is filled, another is copied, and a third is read on
/// the device. In each turn call `fill` and `copy`, enqueue what reads the bytes in the device's stream, and call
/// `read`. Bytes in pinned memory are copied from where they lie.
class staging_ring {
 public:
  static constexpr std::size_t rooms = 3;

  explicit staging_ring(const device& on) : on_(on), copies_(on.id) {
    for (room& r : rooms_) {
      r.copied = own_event(on.id);
      r.read = own_event(on.id);
    }
  }

  /// Call it before the first turn, with the largest sizes of any turn, in bytes, on either side.
  void need(std::size_t pinned, std::size_t there) {
    // Every room is checked: some have no memory if an allocation once failed.
    if (std::ranges::all_of(rooms_,
                            [&](const room& r) { return pinned <= r.pinned.size() && there <= r.there.size(); }))
      return;
    wait();
    for (room& r : rooms_) {
      if (r.pinned.size() < pinned) {
        r.pinned = {};
        r.pinned = pinned_buffer<std::byte>(pinned, on_.id);
      }
      if (r.there.size() < there) {
        r.there = {};
        r.there = device_buffer<std::byte>(there, on_.id);
      }
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

  void wait() const {
    copies_.on().wait();
    on_.wait();
  }

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
    if (r.pinned.size() < bytes) {
      r.pinned = {};
      r.pinned = pinned_buffer<std::byte>(r.there.size(), on_.id);
    }
  }

  device on_;
  own_stream copies_;
  std::array<room, rooms> rooms_;
};

}  // namespace clearance

namespace clearance::minimum {

/// On a device: chunks go through a ring, and a kernel searches one while the next is copied. A cloud on the device is
/// read where it is.
template <class PartView>
class chunked_search<device, PartView> {
 public:
  chunked_search(const device& on, const model_view<PartView>& model)
      : on_(on), search_(on, model), ring_(on), answer_(1, on.id), minima_(search_.parts(), on.id) {
    on_.wait();
  }

  std::size_t parts() const { return search_.parts(); }

  template <class C>
  void operator()(const chunked<C>& chunks, const std::vector<point_range>& ranges,
                  std::span<const Eigen::Isometry3d> poses, const Eigen::Isometry3d& pose, min_distance_result& result,
                  std::span<part_minimum> minima, std::vector<scan::boxed_piece>* seen) {
    try {
      if (minima.empty())
        search<false>(chunks.cloud(), ranges, poses, pose, seen);
      else
        search<true>(chunks.cloud(), ranges, poses, pose, seen);
      ring_.wait();
    } catch (...) {
      finish();
      throw;
    }
    result = *answer_.data();
    std::copy_n(minima_.data(), minima.size(), minima.begin());
    number_as_in_cloud(result, minima,
                       [&](std::uint32_t k, std::uint32_t i) { return std::uint32_t(ranges[k].begin) + i; });
  }

 private:
  template <bool PerPart, class C>
  void search(const C& cloud, const std::vector<point_range>& ranges, std::span<const Eigen::Isometry3d> poses,
              const Eigen::Isometry3d& pose, std::vector<scan::boxed_piece>* seen) {
    using S = loaded_source<C>;
    static_assert(
        requires(const S s) { s.at(s.bytes().data()); },
        "a source that does not say where its bytes are cannot be copied to a device");
    if (seen != nullptr && boxes_.size() < seen->size()) {
      boxes_ = {};
      boxes_ = device_buffer<scan::boxed_piece>(seen->size(), on_.id);
    }
    std::size_t pinned = 0;
    for (const point_range& r : ranges) pinned = std::max(pinned, cloud.bytes_for(r.end - r.begin));
    ring_.need(pinned, 0);
    std::optional<S> there;
    const auto done = [&](std::size_t k) {
      if (seen != nullptr && there)
        scan::enqueue_boxes(on_, *there, boxes_.data() + ranges[k].begin / scan::piece_points);
      ring_.read(k);
    };
    const auto load = [&](std::size_t k) { return placed<S>{load_range(cloud, ranges[k], ring_.fill(k)), pose}; };
    const auto here = [&]<class Its>(const Its& source, std::uint32_t k) {
      if constexpr (std::is_same_v<Its, S>) {
        if (k > 0) done(k - 1);
        const auto bytes = source.bytes();
        const bool is_there = bytes.empty() || on_.holds(bytes.data());
        if (!is_there) ring_.need(0, bytes.size() + 512);  // pieces of a copy begin at multiples of 256
        there.emplace(is_there ? source : source.at(ring_.copy(k, bytes)));
        return *there;
      } else {
        return source;  // of no ranges, no points
      }
    };
    search_.template enqueue<PerPart>(poses, as_they_come(ranges.size(), load), answer_.data(), minima_.data(), here);
    if (!ranges.empty()) done(ranges.size() - 1);
    if (seen == nullptr || seen->empty()) return;
    const device_guard guard(on_.id);
    check_cuda(cudaMemcpyAsync(seen->data(), boxes_.data(), seen->size() * sizeof(scan::boxed_piece),
                               cudaMemcpyDeviceToHost, on_.stream),
               "cudaMemcpyAsync");
  }

  /// Whatever has gone wrong: nothing reads or writes any more.
  void finish() const noexcept {
    try {
      ring_.wait();
    } catch (...) {  // what is told is what went wrong first
    }
  }

  device on_;
  device_search<PartView> search_;
  staging_ring ring_;
  pinned_buffer<min_distance_result> answer_;
  pinned_buffer<part_minimum> minima_;
  device_buffer<scan::boxed_piece> boxes_;
};

}  // namespace clearance::minimum
