// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is every point from closed meshes, and how deep in them?

#include <clearance/frames/root_test.hpp>
#include <clearance/minimum/plain_search.hpp>
#include <clearance/questions/distances.hpp>

namespace clearance {

namespace pointwise {

/// After `distances`: how deep a point is that is 0 away.
template <class PartView, point_source Source, class Traversal>
struct deepen_body {
  const PartView* parts;
  const frames::placement* places;
  std::uint32_t part_count;
  Source source;
  vec3 origin;
  std::uint32_t first;  ///< Number of this cloud's first point among all clouds' points.
  distances_out out;
  Traversal walk;

  CLEARANCE_HD void operator()(std::size_t i) const {
    if (out.distance[first + i] != 0) return;
    const vec3 p = source[i].position - origin;
    found best = read(out, first + i);
    for (std::uint32_t k = 0; k < part_count; ++k) {
      if (!frames::may_reach(places[k].around, 0, p)) continue;
      const auto found = minimum::evaluate(parts[k], places[k].part_from_cloud(p), 0, walk);
      if (found.inside && found.nearest.id != none) best.offer({0 - found.nearest.within, k, found.nearest.id});
    }
    write(out, first + i, best);
  }
};

}  // namespace pointwise

/// Every point's distance to the surface of parts that are closed meshes, negative inside. It is the least of all
/// parts, so a point in several is as deep as in the one where it is deepest. Otherwise as `distances`; `primitive` is
/// the nearest triangle, inside too, and points inside are within any d_max. Refused: d_max that is negative or NaN.
struct signed_distances {
  double d_max = infinity;  ///< Metres; farther points are `+inf`, and cost next to nothing.
  bool which = false;       ///< Whether to tell which part and triangle is nearest, too.

  using result = point_distances;
  using can = clearance::can<choosing, checking, joining, of_points>;
  using out = distances::out;
  template <class On, class PartView>
  using engine = pointwise::engine<On, PartView, signed_distances>;
  template <class PartView>
  using joined = pointwise::joined_points<signed_distances>;
  /// Whether it can be asked about such parts; others do not compile.
  template <class PartView>
  static constexpr bool about = scan::has_interior<PartView>;

  void check() const { limit(); }
  real limit() const {
    if (!(d_max >= 0))
      throw std::invalid_argument("clearance: d_max of signed distances is " + std::to_string(d_max) +
                                  " m; it must not be negative");
    return frames::largest_within(d_max);
  }
  template <class On, class PartView>
  static void check_robot(const On& on, const model_view<PartView>& model) {
    static_assert(
        about<PartView>,
        "signed exact distances are to closed meshes: make the parts of closed_mesh; inner spheres are signed "
        "in `distances`");
    scan::walk_of(on, model);
  }
  template <class On, class PartView, class Clouds>
  static void after(const On& on, const model_view<PartView>& model, std::span<const Eigen::Isometry3d> poses,
                    const Clouds& clouds, const distances_out& out) {
    const auto walk = scan::walk_of(on, model);
    frames::cloud_frame frame;
    frames::for_each_turn(
        frame, model.facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
          static_assert(points_alone<S>());
          auto places = on.template make_scratch<frames::placement>(model.size());
          on.stage(std::span<const frames::placement>(frame.places), places.data());
          on.for_each(source.size(), pointwise::deepen_body<PartView, S, std::remove_const_t<decltype(walk)>>{
                                         model.parts, places.data(), std::uint32_t(model.size()), source, frame.origin,
                                         now.first, out, walk});
        });
  }
};

}  // namespace clearance
