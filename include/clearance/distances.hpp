// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is every point of the clouds from a robot? Runs on the host; include distances.cuh for a device.

#include <clearance/answer/host_points.hpp>
#include <clearance/answer/search_on.hpp>
#include <clearance/scan/plain_pass.hpp>

namespace clearance {

struct distances_options {
  real d_max = infinity;  ///< Metres; farther points are `+inf`, and cost next to nothing.
  bool which = false;     ///< Also which part and primitive is nearest.
};

/// Distances of points, in the order of the clouds and their points.
struct point_distances {
  std::vector<real> distance;  ///< Metres: to sphere parts signed, to triangle parts 0 inside; `+inf` beyond d_max, NaN
                               ///< where there is no point.
  std::vector<std::uint32_t> part,
      primitive;  ///< If `which` is set; of equally near ones the lowest. ~0u: none (for a primitive also: inside).
  point_counts counts;
  distance_certainty certain;
};

namespace pointwise {

inline void check(const distances_options& options) {
  if (!(options.d_max == options.d_max)) throw std::invalid_argument("clearance: d_max is not a number");
}

template <class On>
struct points_on;

/// The prepared question of a backend that has nothing to prepare.
template <class On, class PartView>
struct unprepared {
  On on;
  model_view<PartView> model;

  template <class Clouds, class Here>
  distance_certainty enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const distances_out& out,
                             real d_max, point_counts* counts, const Here& here) const {
    return points_on<On>::once(on, model, poses, clouds, out, d_max, counts, here);
  }
  void forget() const {}
};

/// For a backend without a scan of its own: a loop over points.
template <class On>
struct points_on {
  static_assert(
      !requires { typename On::own_scan; },
      "a device has a scan of its own: include <clearance/distances.cuh>, not the .hpp");

  template <class PartView, class Clouds, class Here>
  static distance_certainty once(const On& on, const model_view<PartView>& model,
                                 std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                 const distances_out& out, real d_max, point_counts* counts, const Here& here) {
    const auto of_cloud = [&]<point_source S>(const S& source, const frames::turn& now) {
      on.for_each(source.size(), clear_body<S>{source, out, now.first});
      return each_point{out, d_max};
    };
    return certainty_of(scan::plain_pass(on, model, poses, clouds, of_cloud, counts, here));
  }

  template <class PartView>
  using kept = unprepared<On, PartView>;
};

template <>
struct points_on<host> {
  template <class PartView, class Clouds, class Here>
  static distance_certainty once(const host& on, const model_view<PartView>& model,
                                 std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                 const distances_out& out, real d_max, point_counts* counts, const Here&) {
    return on_host(on, model, poses, clouds, out, d_max, counts);
  }

  template <class PartView>
  using kept = unprepared<host, PartView>;
};

/// Waits for what `enqueue(out, counts, here)` enqueues; `here(source, cloud)` gives the cloud as the backend can read
/// it.
template <class On, class Clouds, class Enqueue>
point_distances wait_for(const On& on, const Clouds& clouds, const distances_options& options, const Enqueue& enqueue) {
  static_assert(explain_clouds<Clouds>());
  check(options);
  std::size_t points = 0;
  for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d&) { points += source.size(); });
  auto distance = on.template make_scratch<real>(points);
  auto which = on.template make_scratch<std::uint32_t>(options.which ? 2 * points : 0);
  auto counts = on.template make_scratch<point_counts>(1);
  minimum::cloud_copies<On> copies;
  const distances_out out{distance.data(), options.which ? which.data() : nullptr,
                          options.which ? which.data() + points : nullptr};
  point_distances all;
  all.certain = enqueue(out, counts.data(), minimum::readable_on<On>{on, copies});
  if (options.which) all.part = on.copy_out(out.part, points), all.primitive = on.copy_out(out.primitive, points);
  all.distance = on.copy_out(out.distance, points);
  all.counts = on.copy_out(counts.data(), 1)[0];
  return all;
}

}  // namespace pointwise

/// Every point's distance to the nearest part (elsewhere d_max is called max_dist, or activation distance). `poses` and
/// `clouds` as for min_distance. Throws std::invalid_argument if the number of poses is wrong, one is not rigid, or
/// d_max is NaN.
template <class On, robot Robot, class Clouds>
point_distances distances(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                          const Clouds& clouds, const distances_options& options = {}) {
  return pointwise::wait_for(
      on, clouds, options, [&](const distances_out& out, point_counts* counts, const auto& here) {
        return pointwise::points_on<On>::once(on, view_of(robot), poses, clouds, out, options.d_max, counts, here);
      });
}

/// Enqueues it; clouds, and the memory of `out` and `counts`, must stay valid until it is done.
template <class On, robot Robot, class Clouds>
distance_certainty distances_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                   const Clouds& clouds, const distances_out& out, point_counts* counts,
                                   real d_max = infinity) {
  static_assert(explain_clouds<Clouds>());
  pointwise::check({d_max});
  return pointwise::points_on<On>::once(on, view_of(robot), poses, clouds, out, d_max, counts, minimum::as_it_is{});
}

}  // namespace clearance
