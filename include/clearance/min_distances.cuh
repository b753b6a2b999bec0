// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distances of many configurations, on the host or on a device.

#include <clearance/answer/placed_batch.cuh>
#include <clearance/min_distance.cuh>
#include <clearance/min_distances.hpp>

namespace clearance {

/// On a device. It takes its memory from `memory`, a resource that hands out device memory, if you give one.
template <class PartView>
class min_distances_query<device, PartView> : public minimum::placed_batch<PartView, minimum::least_question> {
  using placed = minimum::placed_batch<PartView, minimum::least_question>;

 public:
  /// Throws std::invalid_argument if a tree is too deep for a thread's stack.
  template <robot Robot>
  min_distances_query(const device& on, const Robot& robot, std::pmr::memory_resource* memory = nullptr)
      : placed(on, view_of(robot), memory) {}

  /// As min_distances. The result stays valid until the next call. Points in host memory are copied into buffers that
  /// it keeps.
  template <class Clouds>
  const min_distances_result& operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                         const min_distances_options& options = {}) {
    placed::place(poses);
    return (*this)(clouds, options);
  }
  /// The same for joint vectors, one after another; the device computes their poses.
  template <class Clouds>
  const min_distances_result& operator()(const joint_chain<device>& chain, std::span<const double> q,
                                         const Clouds& clouds, const min_distances_options& options = {}) {
    placed::place(chain, q);
    return (*this)(clouds, options);
  }

  /// Asks about the placed configurations, against a new frame.
  template <class Clouds>
  const min_distances_result& operator()(const Clouds& clouds, const min_distances_options& options = {}) {
    placed::named([&] {
      ask(clouds, options, copies_);
      placed::copy_out(result_.of);
    });
    return result_;
  }
  /// Enqueues it, and returns device memory with one result per configuration, for the next work in its stream. Clouds
  /// must be readable there. A pose that is not rigid makes the state `possible` and the distance NaN, because a device
  /// cannot throw. A graph that captures this is void after more configurations are placed, or a larger cloud is asked
  /// about.
  template <class Clouds>
  const min_distance_result* enqueue(const Clouds& clouds, const min_distances_options& options = {}) {
    ask(clouds, options, minimum::as_it_is{});
    return search_.results();
  }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { search_.forget(); }

 private:
  template <class Clouds, class Here>
  void ask(const Clouds& clouds, const min_distances_options& options, Here&& here) {
    static_assert(explain_clouds<Clouds>());
    placed::check_placed();
    detail::check(options);
    search_.enqueue(clouds, minimum::least_question{options.d_max},
                    [&](const auto& source, std::uint32_t cloud) { return here(source, cloud); });
  }

  using placed::search_, placed::copies_;
  min_distances_result result_;
};

template <robot Robot>
min_distances_query(const device&, const Robot&, std::pmr::memory_resource*)
    -> min_distances_query<device, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

}  // namespace clearance
