// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/distances.hpp>

namespace clearance {

/// The prepared question: make it once for a robot, and ask it in every frame with new poses and points. It answers as
/// `distances` does. On a device it remembers the primitive nearest to each point (by its number), which only makes the
/// next frame faster; other backends have nothing to prepare. Use one object from one thread and one stream; the robot
/// must outlive it.
template <class On, class PartView>
class distances_query {
 public:
  /// `memory` is for a device only: a std::pmr::memory_resource* that hands out device memory.
  template <robot Robot, class... Memory>
  distances_query(const On& on, const Robot& robot, Memory... memory)
      : on_(on), points_{on, view_of(robot), memory...} {}

  /// As `distances`.
  template <class Clouds>
  point_distances operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                             const distances_options& options = {}) {
    return pointwise::wait_for(on_, clouds, options,
                               [&](const distances_out& out, point_counts* counts, const auto& here) {
                                 return points_.enqueue(poses, clouds, out, options.d_max, counts, here);
                               });
  }

  /// As `distances_async`. On a device it waits for nothing, and allocates only for a frame of more points than any
  /// before. A graph that captures this keeps the current poses.
  template <class Clouds>
  distance_certainty enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const distances_out& out,
                             point_counts* counts, real d_max = infinity) {
    static_assert(explain_clouds<Clouds>());
    pointwise::check({d_max});
    return points_.enqueue(poses, clouds, out, d_max, counts, minimum::as_it_is{});
  }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { points_.forget(); }

 private:
  On on_;
  typename pointwise::points_on<On>::template kept<PartView> points_;
};

template <class On, robot Robot, class... Memory>
distances_query(const On&, const Robot&, Memory...)
    -> distances_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

}  // namespace clearance
