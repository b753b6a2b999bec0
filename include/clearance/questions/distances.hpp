// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is every point of the clouds from a robot?

#include <clearance/pointwise/engine.hpp>
#include <clearance/pointwise/joined_points.hpp>
#include <clearance/query/query.hpp>

#if defined(__CUDACC__)
#include <clearance/pointwise/device_points.cuh>
#endif

namespace clearance {

/// Distances of points, in the order of the clouds and their points.
struct point_distances {
  arriving<real> distance;  ///< Metres: to sphere parts signed, to triangle parts 0 inside; `+inf` beyond d_max, NaN
                            ///< where there is no point.
  /// If `which` is set, the nearest part of each point, of equally near ones the lowest; ~0u: none.
  arriving<std::uint32_t> part;
  /// If `which` is set, the nearest primitive of that part; ~0u: none, or the point is inside.
  arriving<std::uint32_t> primitive;
  point_counts counts;
  distance_certainty certain;  ///< What is certain of each distance: the nearest part may be another in truth.
};

/// Every point's distance to the nearest part (elsewhere d_max is called max_dist, or activation distance). A prepared
/// question on a device remembers the primitive nearest to each point, by its number. Refused: d_max that is NaN.
struct distances {
  double d_max = infinity;  ///< Metres; farther points are `+inf`, and cost next to nothing.
  bool which = false;       ///< Whether to tell which part and primitive is nearest, too.

  using result = point_distances;
  using can = clearance::can<checking, joining, of_points>;
  /// One entry per point of all clouds, in memory that the backend writes.
  struct out {
    distances_out distances;
    point_counts* counts;
  };
  template <class On, class PartView>
  using engine = pointwise::engine<On, PartView, distances>;
  template <class PartView>
  using joined = pointwise::joined_points<distances>;

  void check() const { limit(); }
  /// The farthest computed distance that counts.
  real limit() const { return frames::largest_within(d_max); }
  template <class On, class PartView>
  static void check_robot(const On&, const model_view<PartView>&) {}
  template <class On, class PartView, class Clouds>
  static void after(const On&, const model_view<PartView>&, std::span<const Eigen::Isometry3d>, const Clouds&,
                    const distances_out&) {}
};

}  // namespace clearance
