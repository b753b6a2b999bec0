// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/beside.cuh>
#include <clearance/backend/kept_pinned.cuh>
#include <clearance/backend/pinned_buffer.cuh>
#include <clearance/frame/readable.cuh>
#include <clearance/minimum/device_search.cuh>
#include <clearance/minimum/engine.hpp>

namespace clearance::minimum {

/// On a device: one kernel per cloud, no allocation and no synchronisation after the first call. It takes its memory
/// from `memory`, a resource that hands out device memory, if that is given, and from `pinned`, which hands out pinned
/// memory.
template <class PartView, class Q>
class engine<device, PartView, Q> {
 public:
  static constexpr bool takes_pinned = true;

  /// Throws std::invalid_argument if there are more parts than a kernel takes, or trees too deep or wide for its
  /// stacks.
  engine(const device& on, const model_view<PartView>& model, std::pmr::memory_resource* memory = nullptr,
         std::pmr::memory_resource* pinned = kept_pinned())
      : on_(on), search_(on, model, memory), pinned_(pinned), copies_(on, memory) {}
  engine(engine&&) = default;
  ~engine() { settle(); }

  /// The result stays valid until the next call.
  template <class Clouds>
  const typename Q::result& run(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q) {
    begin(poses, clouds, q);
    return finish();
  }
  /// Takes all pinned memory, which a first frame does otherwise. Kept memory is a thread's own, so that a question
  /// that others ask for it takes it here.
  void reserve() {
    if constexpr (Q::per_part)
      if (minima_.data() == nullptr) minima_ = pinned_buffer<part_minimum>(search_.parts(), on_.id, pinned_);
    if (answer_.data() == nullptr) {
      answer_ = pinned_buffer<answer>(1, on_.id, pinned_);
      answer_.data()->done = 0;
    }
  }
  /// Enqueues a frame whose result `finish` waits for.
  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q&) {
    reserve();
    ++frame_number_;
    asked_ = true;
    search_.template enqueue<Q::per_part>(
        poses, clouds, &answer_.data()->result, minima_.data(),
        [&](const auto& source, std::uint32_t cloud) { return copies_(source, cloud); }, &answer_.data()->done,
        frame_number_);
  }
  const typename Q::result& finish() {
    const volatile std::uint32_t& done = answer_.data()->done;
    for (unsigned spins = 1; done != frame_number_; ++spins)
      if (spins % 4096 == 0 && cudaStreamQuery(on_.stream) != cudaErrorNotReady && done != frame_number_) on_.wait();
    asked_ = false;
    if constexpr (Q::per_part) {
      result_.all = answer_.data()->result;
      result_.parts.assign(minima_.data(), minima_.data() + minima_.size());
    } else {
      result_ = answer_.data()->result;
    }
    return result_;
  }

  /// Enqueues a frame; `to` is in device or pinned memory.
  template <class Clouds>
  void start(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q&, const typename Q::out& to) {
    const auto [result, minima] = minima_of<Q>(to);
    search_.template enqueue<Q::per_part>(poses, clouds, result, minima, frames::as_it_is{});
  }
  /// The same with poses in device or pinned memory: one per part, and the cloud's (null: the world's). The frame reads
  /// them when it runs, so a graph that captures this sees the memory of each launch. A pose that is not rigid makes
  /// the state `possible` and the distance NaN, because a device cannot throw.
  template <point_source S>
  void start_with(const world_transform* poses, const S& source, const world_transform* cloud_pose,
                  const typename Q::out& to) {
    const auto [result, minima] = minima_of<Q>(to);
    search_.template enqueue<Q::per_part>(poses, source, cloud_pose, result, minima);
  }

  /// For the next frame only: pairs farther than `within` metres need not be found. If no pair is nearer, the answer
  /// has no witness and the state `no_data`, whatever points there were.
  void bound_by(real within)
    requires(!Q::per_part)
  {
    search_.bound_by(within);
  }
  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { search_.forget(); }

 private:
  struct answer {
    min_distance_result result;
    std::uint32_t done;
  };

  /// Pinned memory is kept for others, so nothing may write to it any more.
  void settle() noexcept {
    if (!asked_) return;
    try {
      on_.wait();
    } catch (...) {  // nothing writes any more
    }
  }

  device on_;
  device_search<PartView> search_;
  std::pmr::memory_resource* pinned_;
  std::uint32_t frame_number_ = 0;
  bool asked_ = false;
  frames::kept_copies copies_;
  pinned_buffer<answer> answer_;
  pinned_buffer<part_minimum> minima_;
  typename Q::result result_;
};

}  // namespace clearance::minimum
