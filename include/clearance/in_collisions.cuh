// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which of many configurations are nearer than a margin, on the host or on a device.

#include <clearance/in_collision.cuh>
#include <clearance/in_collisions.hpp>
#include <clearance/min_distances.cuh>

namespace clearance {

/// On a device. It takes its memory from `memory`, a resource that hands out device memory, if you give one.
template <class PartView>
class in_collisions_query<device, PartView> : public minimum::placed_batch<PartView, minimum::margin_question> {
  using placed = minimum::placed_batch<PartView, minimum::margin_question>;

 public:
  /// Throws std::invalid_argument if a tree is too deep for a thread's stack.
  template <robot Robot>
  in_collisions_query(const device& on, const Robot& robot, std::pmr::memory_resource* memory = nullptr)
      : placed(on, view_of(robot), memory), margins_(std::max<std::size_t>(search_.parts(), 1), on.id, memory) {}

  /// As in_collisions. The result stays valid until the next call. Points in host memory are copied into buffers that
  /// it keeps.
  template <class Clouds>
  const in_collisions_result& operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                         std::span<const double> margins) {
    placed::place(poses);
    return (*this)(clouds, margins);
  }
  /// The same for joint vectors, one after another; the device computes their poses.
  template <class Clouds>
  const in_collisions_result& operator()(const joint_chain<device>& chain, std::span<const double> q,
                                         const Clouds& clouds, double margin = 0) {
    placed::place(chain, q);
    return (*this)(clouds, margin);
  }
  template <class Clouds>
  const in_collisions_result& operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                         double margin = 0) {
    return (*this)(poses, clouds, std::span<const double>(&margin, 1));
  }

  /// Asks about the placed configurations, against a new frame.
  template <class Clouds>
  const in_collisions_result& operator()(const Clouds& clouds, std::span<const double> margins) {
    placed::named([&] {
      ask(clouds, margins, copies_);
      result_.counts = {};
      placed::copy_out(result_.of, &result_.counts);
    });
    return result_;
  }
  template <class Clouds>
  const in_collisions_result& operator()(const Clouds& clouds, double margin = 0) {
    return (*this)(clouds, std::span<const double>(&margin, 1));
  }
  /// Enqueues it, and returns device memory with one state per configuration, for the next work in its stream. Clouds
  /// must be readable there. A pose that is not rigid makes the state `possible`, because a device cannot throw. A
  /// graph that captures this keeps the current margins, and is void after more configurations are placed, or a larger
  /// cloud is asked about.
  template <class Clouds>
  const state* enqueue(const Clouds& clouds, std::span<const double> margins) {
    ask(clouds, margins, minimum::as_it_is{});
    return search_.results();
  }
  template <class Clouds>
  const state* enqueue(const Clouds& clouds, double margin = 0) {
    return enqueue(clouds, std::span<const double>(&margin, 1));
  }

 private:
  template <class Clouds, class Here>
  void ask(const Clouds& clouds, std::span<const double> margins, Here&& here) {
    static_assert(explain_clouds<Clouds>());
    placed::check_placed();
    pairwise::check_margins(margins, search_.parts());
    on_.stage(margins, margins_.data());
    search_.enqueue(clouds, minimum::margin_question{margins_.data(), std::uint32_t(margins.size())},
                    [&](const auto& source, std::uint32_t cloud) { return here(source, cloud); });
  }

  using placed::on_, placed::search_, placed::copies_;
  device_buffer<double> margins_;
  in_collisions_result result_;
};

template <robot Robot>
in_collisions_query(const device&, const Robot&, std::pmr::memory_resource*)
    -> in_collisions_query<device, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

}  // namespace clearance
