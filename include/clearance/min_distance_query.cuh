// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/answer/kept_copies.cuh>
#include <clearance/backend/pinned_buffer.cuh>
#include <clearance/min_distance.cuh>
#include <clearance/min_distance_query.hpp>

namespace clearance {

/// The prepared question on a device: one kernel per cloud, no allocation and no synchronisation after the first call.
/// The answer is that of min_distance, to the bit. It takes its memory from `memory`, a resource that hands out device
/// memory, if you give one, and from `pinned`, which hands out pinned memory.
template <class PartView>
class min_distance_query<device, PartView> {
 public:
  /// Throws std::invalid_argument if there are more parts than a kernel takes, or trees too deep or wide for its
  /// stacks.
  template <robot Robot>
  min_distance_query(const device& on, const Robot& robot, std::pmr::memory_resource* memory = nullptr,
                     std::pmr::memory_resource* pinned = nullptr)
      : on_(on),
        search_(on, view_of(robot), memory),
        copies_(on, memory),
        answer_(1, on.id, pinned),
        minima_(search_.parts(), on.id, pinned) {
    on_.wait();
    answer_.data()->done = 0;
  }

  /// For the next frame only: pairs farther than `within` metres need not be found. If no pair is nearer, the answer
  /// has no witness and the state `no_data`, whatever points there were. Do not use `per_part` for such a frame.
  void bound_by(real within) { search_.bound_by(within); }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { search_.forget(); }

  /// Enqueues one frame. `clouds` as for min_distance must be readable on the device until it is done; `result` is in
  /// device or pinned memory. A graph that captures this keeps the current poses.
  template <class Clouds>
  void enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, min_distance_result* result) {
    search_.template enqueue<false>(poses, clouds, result, nullptr, minimum::as_it_is{});
  }
  template <class Clouds>
  void enqueue_per_part(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, min_distance_result* result,
                        part_minimum* minima) {
    search_.template enqueue<true>(poses, clouds, result, minima, minimum::as_it_is{});
  }

  /// Enqueues one frame with poses in device or pinned memory: one per part, and the cloud's (null: the world's). The
  /// frame reads them when it runs, so a graph that captures this sees the memory of each launch. A pose that is not
  /// rigid makes the state `possible` and the distance NaN, because a device cannot throw.
  template <point_source S>
  void enqueue(const world_transform* poses, const S& source, const world_transform* cloud_pose,
               min_distance_result* result) {
    search_.template enqueue<false>(poses, source, cloud_pose, result, nullptr);
  }
  template <point_source S>
  void enqueue_per_part(const world_transform* poses, const S& source, const world_transform* cloud_pose,
                        min_distance_result* result, part_minimum* minima) {
    search_.template enqueue<true>(poses, source, cloud_pose, result, minima);
  }

  /// One frame; blocks until the answer is there. Points in host memory, pinned ones too, are copied into buffers that
  /// it keeps.
  template <class... Clouds>
  min_distance_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds&... clouds) {
    return ask<false>(poses, as_clouds(clouds...));
  }
  /// As min_distance_per_part; writes `minima`, one per part.
  template <class Clouds>
  min_distance_result per_part(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                               std::span<part_minimum> minima) {
    frames::check_room(search_.parts(), minima.size());
    const min_distance_result result = ask<true>(poses, clouds);
    std::copy_n(minima_.data(), minima.size(), minima.begin());
    return result;
  }

 private:
  template <class, class>
  friend class min_distance_query;  // that of several devices asks one on each

  struct answer {
    min_distance_result result;
    std::uint32_t done;
  };

  template <bool PerPart, class Clouds>
  min_distance_result ask(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds) {
    begin<PerPart>(poses, clouds, [](const auto& source) { return source; });
    return answered();
  }
  /// Enqueues a frame of the piece `piece(source)` of each cloud.
  template <bool PerPart, class Clouds, class Piece>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Piece& piece) {
    ++frame_number_;
    search_.template enqueue<PerPart>(
        poses, clouds, &answer_.data()->result, minima_.data(),
        [&](const auto& source, std::uint32_t cloud) { return copies_(piece(source), cloud); }, &answer_.data()->done,
        frame_number_);
  }
  /// Waits for it.
  const min_distance_result& answered() const {
    const volatile std::uint32_t& done = answer_.data()->done;
    for (unsigned spins = 1; done != frame_number_; ++spins)
      if (spins % 4096 == 0 && cudaStreamQuery(on_.stream) != cudaErrorNotReady && done != frame_number_) on_.wait();
    return answer_.data()->result;
  }

  device on_;
  minimum::device_search<PartView> search_;
  std::uint32_t frame_number_ = 0;
  minimum::kept_copies copies_;
  pinned_buffer<answer> answer_;
  pinned_buffer<part_minimum> minima_;
};

template <robot Robot>
min_distance_query(const device&, const Robot&, std::pmr::memory_resource*)
    -> min_distance_query<device, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

}  // namespace clearance
