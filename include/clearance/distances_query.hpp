// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/distances.hpp>

namespace clearance {

/// A prepared question: made once for a robot, asked every frame with new poses and points, it says what `distances`
/// says. On a device it remembers which primitive was the nearest to each point (of its number), which only ever makes
/// the next frame faster; elsewhere there is nothing to prepare. One object is for one thread and one stream; the robot
/// must stay.
template <class On, class PartView>
class distances_query {
 public:
  /// `memory`, a device's alone: a std::pmr::memory_resource* that hands out device memory.
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

  /// As `distances_async`. On a device nothing is allocated and nothing waited for, but by a frame of more points than
  /// any before. A graph that captures this keeps the poses of now.
  template <class Clouds>
  distance_certainty enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const distances_out& out,
                             point_counts* counts, real d_max = infinity) {
    static_assert(explain_clouds<Clouds>());
    pointwise::check({d_max});
    return points_.enqueue(poses, clouds, out, d_max, counts, minimum::as_it_is{});
  }

  /// Drops what is known of the last frame. The next one starts cold; its answer is the same.
  void forget() { points_.forget(); }

 private:
  On on_;
  typename pointwise::points_on<On>::template kept<PartView> points_;
};

template <class On, robot Robot, class... Memory>
distances_query(const On&, const Robot&, Memory...)
    -> distances_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

}  // namespace clearance
