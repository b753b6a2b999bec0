// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is every point from every part? Runs on the host; include distances_per_part.cuh for a device.

#include <clearance/answer/margins.hpp>
#include <clearance/answer/written.hpp>
#include <clearance/collect_query.hpp>
#include <clearance/distances.hpp>

namespace clearance {

/// Each part's distance to all points: those of part k are of(k), in the order of the clouds and their points.
struct part_distances {
  std::vector<real> distance;  ///< Metres: to sphere parts signed, to triangle parts 0 inside; `+inf` beyond d_max, NaN
                               ///< where there is no point.
  std::size_t points = 0;
  point_counts counts;
  distance_certainty certain;

  std::span<const real> of(std::size_t part) const { return std::span(distance).subspan(part * points, points); }
};

/// The prepared question: make it once for a robot, and ask it in every frame with new poses and points. Use one object
/// from one thread and one stream; the robot must outlive it.
template <class On, class PartView>
class distances_per_part_query {
 public:
  /// `memory` is for a device only: a std::pmr::memory_resource* that hands out device memory.
  template <robot Robot, class... Memory>
  distances_per_part_query(const On& on, const Robot& robot, Memory... memory)
      : question_(on, view_of(robot), memory...) {}

  /// As `distances_per_part`. Points that a device cannot read are copied into buffers that it keeps.
  template <class Clouds>
  part_distances operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, real d_max = infinity) {
    static_assert(explain_clouds<Clouds>());
    auto& memory = question_.memory;
    memory.begin();
    part_distances all;
    all.points = points_of(clouds);
    const std::size_t numbers = all.points * question_.model.size();
    real* const distance = memory.template room<real>(numbers).data();
    point_counts* const counts = memory.template room<point_counts>(1).data();
    all.certain = ask(poses, memory.readable(clouds), all.points, distance, counts, d_max);
    all.distance = question_.on.copy_out(distance, numbers);
    all.counts = question_.on.copy_out(counts, 1)[0];
    return all;
  }

  /// As `distances_per_part_async`. On a device it waits for nothing, and allocates only for more clouds than ever
  /// before. A graph that captures this keeps the current poses.
  template <class Clouds>
  distance_certainty enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, real* distance,
                             point_counts* counts, real d_max = infinity) {
    static_assert(explain_clouds<Clouds>());
    question_.memory.begin();
    return ask(poses, clouds, points_of(clouds), distance, counts, d_max);
  }

 private:
  template <class Clouds>
  static std::size_t points_of(const Clouds& clouds) {
    std::size_t points = 0;
    for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d&) { points += source.size(); });
    return points;
  }

  template <class Clouds>
  distance_certainty ask(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, std::size_t points,
                         real* distance, point_counts* counts, real d_max) {
    pointwise::check({d_max});
    auto& frame = question_.ahead.frame;
    auto& first = question_.ahead.first;
    first.clear();
    frames::for_each_turn(
        frame, question_.model.facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
          first.push_back(now.first);
          question_.on.for_each(source.size(), pairwise::nothing_written<S>{source, distance + now.first, points,
                                                                            question_.model.size()});
        });
    const auto [start] = question_.memory.put(first);
    question_.ask(poses, clouds, pairwise::written{distance, start, points, d_max}, counts);
    return certainty_of(frame);
  }

  pairwise::pair_question<On, PartView> question_;
};
template <class On, robot Robot, class... Memory>
distances_per_part_query(const On&, const Robot&, Memory...)
    -> distances_per_part_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

/// Every point's distance to every part: parts times points numbers. `poses` and `clouds` as for min_distance. Throws
/// std::invalid_argument if the number of poses is wrong, one is not rigid, or d_max is NaN.
template <class On, robot Robot, class Clouds>
part_distances distances_per_part(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                  const Clouds& clouds, real d_max = infinity) {
  return pairwise::asked_once<distances_per_part_query>(on, robot,
                                                        [&](auto& query) { return query(poses, clouds, d_max); });
}

/// Enqueues it: part k's distances to `distance[k * points]` and on, where `points` is the number of points of all
/// clouds. Clouds, and the memory of `distance` and `counts`, must stay valid until it is done.
template <class On, robot Robot, class Clouds>
distance_certainty distances_per_part_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                            const Clouds& clouds, real* distance, point_counts* counts,
                                            real d_max = infinity) {
  return pairwise::asked_once<distances_per_part_query>(
      on, robot, [&](auto& query) { return query.enqueue(poses, clouds, distance, counts, d_max); });
}

}  // namespace clearance
