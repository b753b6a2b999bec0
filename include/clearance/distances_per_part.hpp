// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is every point from every part? On the host; distances_per_part.cuh has a device.

#include <clearance/answer/margins.hpp>
#include <clearance/answer/written.hpp>
#include <clearance/collect.hpp>
#include <clearance/distances.hpp>

namespace clearance {

/// Each part's distance to all points: those of part k are of(k), in the order of the clouds and their points.
struct part_distances {
  std::vector<real> distance;  ///< Metres: to sphere parts signed, to triangle parts 0 inside; `+inf` beyond d_max, NaN where there is no point.
  std::size_t points = 0;
  point_counts counts;
  distance_certainty certain;

  std::span<const real> of(std::size_t part) const { return std::span(distance).subspan(part * points, points); }
};

namespace pairwise {

template <class On, class PartView, class Clouds, class Here>
distance_certainty enqueue_per_part(const On& on, const model_view<PartView>& model, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                    std::size_t points, real* distance, real d_max, point_counts* counts, const Here& here) {
  pointwise::check({d_max});
  std::vector<std::uint32_t> first;
  distance_certainty certain;
  frames::cloud_frame frame;
  frames::for_each_turn(frame, model.facts, poses, clouds, [&]<point_source S>(const S& anywhere, const frames::turn& now) {
    first.push_back(now.first);
    on.for_each(anywhere.size(), nothing_written<S>{here(anywhere, now.cloud), distance + now.first, points, model.size()});
  });
  certain = certainty_of(frame);
  const auto start = staged(on, first);
  pairs_on<On>::once(on, model, poses, clouds, written{distance, start.data(), points, d_max}, counts, here);
  return certain;
}

}  // namespace pairwise

/// Every point's distance to every part: parts times points numbers. `poses` and `clouds` as for min_distance. Throws
/// std::invalid_argument if the number of poses is wrong, one is not rigid, or d_max is NaN.
template <class On, robot Robot, class Clouds>
part_distances distances_per_part(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, real d_max = infinity) {
  static_assert(explain_clouds<Clouds>());
  const auto model = view_of(robot);
  part_distances all;
  for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d&) { all.points += source.size(); });
  auto distance = on.template make_scratch<real>(all.points * model.size());
  auto counts = on.template make_scratch<point_counts>(1);
  minimum::cloud_copies<On> copies;
  all.certain =
      pairwise::enqueue_per_part(on, model, poses, clouds, all.points, distance.data(), d_max, counts.data(), minimum::readable_on<On>{on, copies});
  all.distance = on.copy_out(distance.data(), all.points * model.size());
  all.counts = on.copy_out(counts.data(), 1)[0];
  return all;
}

/// Enqueues it: part k's distances to `distance[k * points]` and on, where `points` is the number of points of all clouds. Clouds, and the
/// memory of `distance` and `counts`, must stay until it is done.
template <class On, robot Robot, class Clouds>
distance_certainty distances_per_part_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                            real* distance, point_counts* counts, real d_max = infinity) {
  static_assert(explain_clouds<Clouds>());
  std::size_t points = 0;
  for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d&) { points += source.size(); });
  return pairwise::enqueue_per_part(on, view_of(robot), poses, clouds, points, distance, d_max, counts, minimum::as_it_is{});
}

}  // namespace clearance
