// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/frame/clouds.hpp>
#include <clearance/minimum/least.cuh>
#include <clearance/minimum/of_pieces.hpp>
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
        of_group_(launch_.groups() == 1 ? 0 : launch_.groups(), on.id, memory) {
    const device_guard guard(on.id);
    check_cuda(cudaMemsetAsync(witnesses_.data(), 0, witnesses_.size() * sizeof(typename one::witness_type), on.stream),
               "cudaMemsetAsync");
    forget_bounds();
  }

  /// Drops what is known of the last frame. The next one starts cold; its answer is the same.
  void forget() { launch_.forget(), forget_bounds(); }

  /// The next frame alone, which must not be `PerPart`, need not find anything farther than `within`. Enqueued.
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
    const bool alone = launch_.groups() == 1;
    const std::uint32_t before = group * scan::most_parts;
    const auto around = scan::elements_of(source);
    auto a = launch_.template begin<least<PartView, PerPart, std::remove_const_t<decltype(around)>>>(
        group, now,
        {state_.data() + group, witnesses_.data() + before,
         records_.data() + std::size_t(before) * launch_.most_blocks(),
         candidates_.data() + group * launch_.most_blocks(), alone ? end.result : of_group_.data() + group,
         PerPart ? end.minima + before : nullptr, launch_.fields(group), around});
    if (alone) a.done = end.done, a.number = end.number;
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
  frames::cloud_frame frame_;
};

}  // namespace clearance::minimum
