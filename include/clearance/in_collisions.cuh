// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which of many configurations are nearer than a margin, on the host or on a device.

#include <clearance/in_collision.cuh>
#include <clearance/in_collisions.hpp>
#include <clearance/min_distances.cuh>

namespace clearance {

/// On a device. Memory for its own use comes from `memory`, a resource that hands out device memory, if one is given.
template <class PartView>
class in_collisions_query<device, PartView> : public minimum::placed_batch<PartView, minimum::margin_question> {
  using placed = minimum::placed_batch<PartView, minimum::margin_question>;

 public:
  /// Throws std::invalid_argument if a tree is too deep for a thread's stack.
  template <robot Robot>
  in_collisions_query(const device& on, const Robot& robot, std::pmr::memory_resource* memory = nullptr)
      : placed(on, view_of(robot), memory), margins_(std::max<std::size_t>(search_.parts(), 1), on.id, memory) {}

  /// As in_collisions. What is returned stays until the next call. Points in host memory are copied into buffers that
  /// are kept.
  template <class Clouds>
  const in_collisions_result& operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                         std::span<const double> margins) {
    placed::place(poses);
    return (*this)(clouds, margins);
  }
  /// The same of joint vectors, one after another, whose poses the device computes.
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

  /// The configurations that were placed, against a new frame.
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
  /// Enqueues it: what is returned is memory of the device, one state a configuration, for what follows in its stream.
  /// Clouds must be readable there. If a pose is not rigid, which cannot be thrown there, the state is `possible`. A
  /// graph that captures this keeps the margins of now, and is void once more configurations are placed, or a larger
  /// cloud is asked.
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
