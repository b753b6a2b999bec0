// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Fields of parts bound their distances, and change no answer.
#include "minimum/edge_scenes.hpp"
#include "solid/shapes.hpp"
#include "support/brute_pairs.hpp"
#include "support/configurations.hpp"
#include "support/same_answer.hpp"

#include <clearance/make_model.hpp>
#include <clearance/near_maps.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace testing {

/// Robots with fields, and their laws.
template <class On>
struct fields_law {
  On on;
  verdict v = {};
  std::size_t sides[3] = {}, far = 0;
  double wide = 0, count = 0;

  /// The robot with fields; all its parts must have one.
  template <class Model>
  Model with(const Model& model, const std::string& what, std::size_t bytes = 1 << 16) {
    auto made = clearance::with_fields(on, model, {bytes});
    for (const auto& why_not : made.without) v.require(why_not.empty(), what, ": ", why_not);
    v.require(made.model.view().fields != nullptr, what, ": no field");
    return std::move(made.model);
  }

  /// Bounds contain the computed distance and sides are right, in all boxes, beyond them, near and on the surface.
  template <class Model>
  void check(const Model& model, dice& d, const std::string& what) {
    const auto view = model.view();
    if (view.fields == nullptr) return;
    for (std::size_t k = 0; k < view.size(); ++k) {
      const auto& part = view.parts[k];
      const auto& field = view.fields[k];
      for (int i = 0; i < 2000; ++i) {
        const double reach = double(field.around.radius) * std::pow(2.0, d.number(-6, 6));
        vec3 q = field.around.center + d.point(reach);
        if (i % 4 == 0) {  // on a primitive, or a little off
          clearance::minimum::nearest_primitive<typename Model::view_type::hierarchy_type::primitive_type> near{
              infinity};
          walk(part.tree, q, near);
          if (near.id != clearance::none) q = near.primitive.nearest(q) + (i % 8 ? d.point(1e-3 * reach) : vec3{});
        }
        clearance::nearest near;
        walk(part.tree, q, near);
        const auto its = field(q);
        v.require(its.low <= near.within && near.within <= its.high, what, ", part", k, ": ", near.within,
                  " is not between", its.low, its.high, " at", q.x, q.y, q.z);
        ++sides[int(its.side)], far += its.high - its.low > field.around.radius;
        wide += double(its.high - its.low) / double(field.around.radius + near.within), ++count;
        if constexpr (clearance::scan::has_interior<typename Model::view_type>)
          if (its.side != clearance::field_side::unknown)
            v.require(part.interior.inside(q) == (its.side == clearance::field_side::inside), what, ", part", k,
                      ": another side at", q.x, q.y, q.z);
      }
    }
  }

 private:
  template <class Tree, class Q>
  static void walk(const Tree& tree, vec3 q, Q& found) {
    clearance::any_depth{clearance::stack_need(tree)}(tree, q, found);
  }
};

/// Questions about pairs of a point and a part, in some configurations: distances far from and near to the parts.
template <class On, class Bare, class Fielded, class Clouds>
void require_no_change_of_pairs(const On& on, const Bare& bare, const Fielded& fielded, const configurations& poses,
                                const Clouds& clouds, double size, verdict& v, const std::string& what) {
  const std::size_t parts = view_of(bare).size();
  const auto same = [&](std::span<const Eigen::Isometry3d> at, const auto& q, const char* of, double reach) {
    v.require(same_answer(ask(clearance::host{1}, bare, at, clouds, q), ask(on, fielded, at, clouds, q)), what, ": ",
              of, ", ", reach);
  };
  for (std::size_t c = 0; c < std::min<std::size_t>(4, poses.size() / parts); ++c) {
    const std::span<const Eigen::Isometry3d> at(poses.data() + c * parts, parts);
    for (const double reach : {0.0, 0.03 * size, 0.4 * size}) {
      same(at, clearance::zones{.thresholds = {0, reach / 2, reach}}, "zones", reach);
      same(at, clearance::in_collision{{reach}}, "in_collision", reach);
      same(at, clearance::within{{reach}}, "within", reach);
      same(at, clearance::self_filter{.padding = {reach}}, "self_filter", reach);
    }
    same(at, clearance::min_distance_per_part{}, "every part's minimum", clearance::infinity);
    for (const double d_max : {0.05 * size, double(infinity)})
      same(at, clearance::distances{.d_max = d_max, .which = true}, "distances", d_max);
  }
}

/// Every question about configurations gives the robot with fields the answers of the one without, in every bit.
template <class On, class Bare, class Fielded, class Clouds>
void require_no_change(const On& on, const Bare& bare, const Fielded& fielded, const configurations& poses,
                       const Clouds& clouds, double size, verdict& v, const std::string& what) {
  using clearance::host;
  const auto same = [&](const auto& found, const auto& expected, const std::string& of) {
    v.require(found.size() == expected.size(), of, ": another number");
    for (std::size_t c = 0; c < found.size() && c < expected.size(); ++c)
      v.require(same_result(found[c], expected[c]), of, ", configuration", c, ": ", found[c].distance, " at",
                found[c].point, ",", found[c].part, " instead of", expected[c].distance, " at", expected[c].point, ",",
                expected[c].part);
  };
  clearance::query query(on, fielded, clearance::min_distances{});
  for (const double d_max : {-0.05, 0.0, 0.2, double(infinity)}) {
    const real most = real(d_max * size);
    const std::string which = what + ", d_max " + std::to_string(most);
    const auto expected = ask(host{1}, bare, poses, clouds, clearance::min_distances{most}).of;
    same(query(poses, clouds, {most}).of, expected, which + ", prepared");
    same(query(poses, clouds, {most}).of, expected, which + ", warm");
    if (d_max > 0.1) same(ask(on, fielded, poses, clouds, clearance::min_distances{most}).of, expected, which);
  }
  same(ask(on, fielded, poses, clouds, clearance::min_distances_per_part{}).all,
       ask(host{1}, bare, poses, clouds, clearance::min_distances_per_part{}).all, what + ", each part");
  for (const double margin : {-0.1, 0.0, 1e-7, 0.02, 0.3}) {
    std::vector<double> margins(view_of(bare).size(), margin * size);
    margins[0] *= 3;
    const auto expected = ask(host{1}, bare, poses, clouds, clearance::in_collisions{{margins}});
    v.require(ask(on, fielded, poses, clouds, clearance::in_collisions{{margins}}).of == expected.of, what, ", margin",
              margin, ": other states");
  }
  require_no_change_of_pairs(on, bare, fielded, poses, clouds, size, v, what);
}

/// All scenes, extreme ones, solids with a tolerance, and a crowd; fields are sampled by `on`.
template <class On>
void check_fields(const On& on) {
  fields_law<On> law{on};
  dice d(431);
  const auto compare = [&](const auto& bare, const configurations& poses, const auto& clouds, double size,
                           const std::string& what) {
    const auto fielded = law.with(bare, what);
    law.check(fielded, d, what);
    require_no_change(on, bare, fielded.on(on), poses, clouds, size, law.v, what);
  };
  for (const auto& s : scenes<inner_sphere>())
    compare(make_model<clearance::sphere>(s, {}, clearance::wrapped{}), configurations_of(s, d),
            clearance::placed{clearance::point_span(s.points), s.cloud_pose}, s.size, s.name);
  for (const auto& s : scenes<triangle>()) {
    const sources<triangle> all(s);
    compare(make_model<clearance::obb>(s, {.width = 8}, clearance::wrapped{}), configurations_of(s, d),
            std::tuple(clearance::placed{all.raw, all.camera_pose},
                       std::vector(2, clearance::placed{all.doubles, s.cloud_pose})),
            s.size, s.name + ", triangles, several clouds");
  }
  for (const double tolerance : {0.0, 0.3, 2.0}) {
    configurations poses;
    for (int c = 0; c < 60; ++c)
      for (int k = 0; k < 2; ++k) poses.push_back(d.pose(0.1 * c));
    for (const std::size_t points : {40u, 3000u}) {
      const auto cloud = d.points(points, 3);
      compare(clearance::make_model<clearance::aabb>(std::vector(2, clearance::close_mesh(shapes::cube(1))),
                                                     clearance::part_options{.tolerance = tolerance}),
              poses, clearance::placed{clearance::point_span(cloud), d.pose(0.1)}, 1,
              "solids, tolerance " + std::to_string(tolerance) + ", " + std::to_string(points) + " points");
    }
  }
  auto s = crowd(416);
  s.points.push_back({1e6f, -1e6f, 1e5f});
  compare(make_model<clearance::sphere>(s, {}, clearance::wrapped{}), configurations_of(s, d, 12),
          clearance::point_span(s.points), 1, "a crowd");
  CHECK((law.sides[0] > 1000 && law.sides[1] > 1000 && law.sides[2] > 1000 && law.far > 100));
  CHECK(law.wide / law.count < 0.25);  // of the distance and the part's radius: a table of 64 KiB tells something
}

}  // namespace testing
