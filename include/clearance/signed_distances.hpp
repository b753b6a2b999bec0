// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is every point from closed meshes, and how deep in them? Runs on the host; include signed_distances.cuh for a
// device.

#include <clearance/answer/witness.hpp>
#include <clearance/distances.hpp>
#include <clearance/frame/root_test.hpp>

namespace clearance {

namespace pointwise {

/// After `distances`: how deep a point is that is 0 away.
template <class PartView, point_source Source>
struct deepen_body {
  const PartView* parts;
  const frames::placement* places;
  std::uint32_t part_count;
  Source source;
  vec3 origin;
  std::uint32_t first;  ///< Number of this cloud's first point among all clouds' points.
  distances_out out;
  any_depth walk;

  CLEARANCE_HD void operator()(std::size_t i) const {
    if (out.distance[first + i] != 0) return;
    const vec3 p = source[i].position - origin;
    found best = read(out, first + i);
    for (std::uint32_t k = 0; k < part_count; ++k) {
      if (!frames::may_reach(places[k].around, 0, p)) continue;
      const auto its = minimum::evaluate(parts[k], places[k].part_from_cloud(p), 0, walk);
      if (its.inside && its.nearest.id != none) best.offer({0 - its.nearest.within, k, its.nearest.id});
    }
    write(out, first + i, best);
  }
};

template <class On, robot Robot, class Clouds, class Here>
distance_certainty enqueue_signed(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                  const Clouds& clouds, const distances_out& out, real d_max, point_counts* counts,
                                  const Here& here) {
  static_assert(explain_clouds<Clouds>());
  const auto model = view_of(robot);
  using part_view = std::remove_const_t<std::remove_pointer_t<decltype(model.parts)>>;
  static_assert(scan::has_interior<part_view>,
                "signed exact distances are to closed meshes: make the parts of closed_mesh; inner spheres are signed "
                "in `distances`");
  if (!(d_max >= 0))
    throw std::invalid_argument("clearance: d_max of signed distances is " + std::to_string(d_max) +
                                " m; it must not be negative");
  if constexpr (requires { typename On::own_scan; }) minimum::check_stack<near_first>(model.depth, model.width);
  const distance_certainty certain = points_on<On>::once(on, model, poses, clouds, out, d_max, counts, here);
  frames::cloud_frame frame;
  frames::for_each_turn(
      frame, model.facts, poses, clouds, [&]<point_source S>(const S& anywhere, const frames::turn& now) {
        auto places = on.template make_scratch<frames::placement>(model.size());
        on.stage(std::span<const frames::placement>(frame.places), places.data());
        const S source = here(anywhere, now.cloud);
        on.for_each(source.size(), deepen_body<part_view, S>{model.parts, places.data(), std::uint32_t(model.size()),
                                                             source, frame.origin, now.first, out,
                                                             any_depth{stack_need(model.depth, model.width)}});
      });
  return certain;
}

}  // namespace pointwise

/// Every point's distance to the surface of parts that are closed meshes, negative inside. It is the least of all
/// parts, so a point in several is as deep as in the one where it is deepest. Otherwise as `distances`; `primitive` is
/// the nearest triangle, inside too, and points inside are within any d_max. Throws std::invalid_argument as that does,
/// and if d_max is negative.
template <class On, robot Robot, class Clouds>
point_distances signed_distances(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                 const Clouds& clouds, const distances_options& options = {}) {
  return pointwise::wait_for(
      on, clouds, options, [&](const distances_out& out, point_counts* counts, const auto& here) {
        return pointwise::enqueue_signed(on, robot, poses, clouds, out, options.d_max, counts, here);
      });
}

/// Enqueues it; clouds, and the memory of `out` and `counts`, must stay valid until it is done.
template <class On, robot Robot, class Clouds>
distance_certainty signed_distances_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                          const Clouds& clouds, const distances_out& out, point_counts* counts,
                                          real d_max = infinity) {
  return pointwise::enqueue_signed(on, robot, poses, clouds, out, d_max, counts, minimum::as_it_is{});
}

}  // namespace clearance
