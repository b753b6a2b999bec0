// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance on a device, frame after frame, with one kernel per cloud.

#include <clearance/backends/device_buffer.cuh>
#include <clearance/backends/own_stream.cuh>
#include <clearance/backends/readback.cuh>
#include <clearance/frames/clouds.hpp>
#include <clearance/frames/readable.cuh>
#include <clearance/minimum/engine.hpp>
#include <clearance/minimum/least.cuh>
#include <clearance/minimum/merge.hpp>
#include <clearance/scan/launch.cuh>

namespace clearance::minimum {

/// Merges the results of groups of parts into the robot's. Each group had its own kernel and has seen the same points.
template <bool HasInterior>
__global__ void merge_groups(const min_distance_result* of_group, std::uint32_t groups, min_distance_result* result,
                             std::uint32_t* done, std::uint32_t number) {
  of_pieces robot(of_group[0]);
  for (std::uint32_t g = 1; g < groups; ++g) {
    of_pieces next(of_group[g]);
    if (next.all.part != none) next.all.part += g * scan::most_parts;
    robot.add_parts(next);
  }
  *result = robot.answer(HasInterior);
  if (done == nullptr) return;
  __threadfence_system();
  *static_cast<volatile std::uint32_t*>(done) = number;
}

/// The least distance on a device, frame after frame, with one kernel per cloud. It allocates nothing and never waits.
/// The last minima give the next frame a first bound, which changes only how long it takes.
template <class PartView>
class device_search {
 public:
  device_search(const device& on, const model_view<PartView>& model, std::pmr::memory_resource* memory = nullptr)
      : on_(on),
        facts_(model.facts.begin(), model.facts.end()),
        launch_(on, model, memory),
        state_(launch_.groups(), on.id, memory),
        witnesses_(launch_.groups() * scan::most_parts, on.id, memory),
        records_(launch_.most_blocks() * model.size(), on.id, memory),
        candidates_(launch_.groups() * launch_.most_blocks(), on.id, memory),
        of_group_(launch_.groups() == 1 ? 0 : launch_.groups(), on.id, memory),
        extra_(frames::parts_decide(model.facts) ? model.size() : 0, on.id, memory) {
    const device_guard guard(on.id);
    std::vector<real> extra;
    frames::extra_reaches(facts_, extra);
    on.stage(std::span<const real>(extra), extra_.data());
    check_cuda(cudaMemsetAsync(witnesses_.data(), 0, witnesses_.size() * sizeof(typename one::witness_type), on.stream),
               "cudaMemsetAsync");
    forget_bounds();
  }

  /// Drops what is known of the last frame. The next one starts cold; its answer is the same.
  void forget() {
    launch_.forget();
    forget_bounds();
  }

  /// The next frame alone, which must not be `PerPart`, need not find anything farther than `within`, unless it may
  /// decide what is certain. Enqueued.
  void bound_by(real within) {
    const std::uint32_t bound = ordered(within);
    for (std::uint32_t group = 0; group < launch_.groups(); ++group)
      on_.stage(std::span(&bound, 1), state_.data()[group].bound);
  }

  std::size_t parts() const { return facts_.size(); }

  /// Enqueues one frame. With `PerPart` it also writes `minima`, one per part. `here(source, cloud)` returns a source
  /// that the device can read. At the end it writes `number` to `done`, unless that is null.
  template <bool PerPart, class Clouds, class Here>
  void enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, min_distance_result* result,
               part_minimum* minima, const Here& here, std::uint32_t* done = nullptr, std::uint32_t number = 0) {
    const ending end{result, minima, done, number};
    try {
      frames::for_each_turn(frame_, facts_, poses, clouds, [&](const auto& anywhere, const frames::turn& now) {
        const auto source = here(anywhere, now.cloud);
        for (std::uint32_t group = 0; group < launch_.groups(); ++group)
          start<PerPart>(source, group, now, end, [&](auto& a) { launch_.put(frame_, group, a); });
      });
      conclude(end);
    } catch (...) {
      forget();  // the clouds before this one have left their bounds and minima
      throw;
    }
  }

  /// Enqueues one frame with poses in device or pinned memory: one per part, and the cloud's (null: the cloud is in
  /// world coordinates).
  template <bool PerPart, point_source S>
  void enqueue(const world_transform* poses, const S& source, const world_transform* cloud_pose,
               min_distance_result* result, part_minimum* minima) {
    const ending end{result, minima, nullptr, 0};
    launch_.place(poses, cloud_pose, rounding_of(source));
    for (std::uint32_t group = 0; group < launch_.groups(); ++group)
      start<PerPart>(source, group, {0, 0, true}, end, [](auto& a) { a.far = a.placed = true; });
    conclude(end);
  }

 private:
  using one = least<PartView, false>;
  struct ending {
    min_distance_result* result;
    part_minimum* minima;
    std::uint32_t* done;
    std::uint32_t number;
  };

  void forget_bounds() {
    const typename one::state_type fresh;
    for (std::uint32_t group = 0; group < launch_.groups(); ++group)
      on_.stage(std::span(&fresh, 1), state_.data() + group);
  }

  template <bool PerPart, class Source, class Place>
  void start(const Source& source, std::uint32_t group, const frames::turn& now, const ending& end,
             const Place& place) {
    using around = decltype(scan::elements_of(source));
    if constexpr (cored_hierarchy<typename PartView::hierarchy_type> && std::is_same_v<around, scan::as_points>)
      if (launch_.has_cells()) return start_as<least<celled_view<PartView>, PerPart>>(source, group, now, end, place);
    start_as<least<PartView, PerPart, around>>(source, group, now, end, place);
  }
  template <class Tally, class Source, class Place>
  void start_as(const Source& source, std::uint32_t group, const frames::turn& now, const ending& end,
                const Place& place) {
    const bool alone = launch_.groups() == 1;
    const std::uint32_t before = group * scan::most_parts;
    auto a = launch_.template begin<Tally>(
        group, now,
        {state_.data() + group, witnesses_.data() + before,
         records_.data() + std::size_t(before) * launch_.most_blocks(),
         candidates_.data() + group * launch_.most_blocks(), alone ? end.result : of_group_.data() + group,
         Tally::bound_per_part ? end.minima + before : nullptr,
         Tally::bound_per_part || extra_.size() == 0 ? nullptr : extra_.data() + before, launch_.fields(group),
         scan::elements_of(source)});
    if (alone) {
      a.done = end.done;
      a.number = end.number;
    }
    place(a);
    launch_(source, a);
  }
  void conclude(const ending& end) {
    if (launch_.groups() == 1) return;
    on_.launch(merge_groups<scan::has_interior<PartView>>, 1, 1, 0, of_group_.data(), launch_.groups(), end.result,
               end.done, end.number);
  }

  device on_;
  std::vector<part_facts> facts_;
  scan::launcher<PartView> launch_;
  device_buffer<typename one::state_type> state_;
  device_buffer<typename one::witness_type> witnesses_;
  device_buffer<typename one::record> records_;
  device_buffer<typename one::witness_type> candidates_;
  device_buffer<min_distance_result> of_group_;
  device_buffer<real> extra_;  ///< See extra_reaches.
  frames::cloud_frame frame_;
};

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

  /// Enqueues a frame whose result `finish` waits for. Its last kernel writes it to pinned memory.
  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q&) {
    if constexpr (Q::per_part)
      if (minima_.data() == nullptr) minima_ = pinned_buffer<part_minimum>(search_.parts(), on_.id, pinned_);
    if (answer_.data() == nullptr) {
      answer_ = pinned_buffer<answer>(1, on_.id, pinned_);
      answer_.data()->done = 0;
    }
    ++frame_number_;
    asked_ = true;
    search_.template enqueue<Q::per_part>(
        poses, clouds, &answer_.data()->result, minima_.data(),
        [&](const auto& source, std::uint32_t cloud) { return copies_(source, cloud); }, &answer_.data()->done,
        frame_number_);
  }
  /// The result stays valid until the next call.
  const typename Q::result& finish() {
    backends::watch(on_, answer_.data()->done, frame_number_);
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

  /// For the next frame only: pairs farther than `within` metres need not be found, unless they may decide what is
  /// certain. If none is found, the answer has no witness and the state `no_data`, whatever points there were.
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
