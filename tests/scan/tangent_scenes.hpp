// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Robots before points that lie together, or almost, for walks by tangents. `check(scene, model, points, what, inside)`
// asks somewhere: `inside(k, q)` says if q is in part k's solid.

#include "solid/shapes.hpp"
#include "support/brute_distances.hpp"

#include <clearance/make_model.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace testing {

/// Neighbours of all sizes and shapes, among them repeated, far and missing points.
inline std::vector<vec3> patches(dice& d, double extent) {
  std::vector<vec3> points;
  for (int patch = 0; patch < 60; ++patch) {
    const vec3 corner = d.point(extent * (patch % 5 == 0 ? 20 : 1), {0, 0, 0});
    const real step = real(extent * std::pow(10, d.number(-6, -1)));
    const vec3 along = d.point(1, {0, 0, 0}), across = d.point(1, {0, 0, 0});
    const int columns = 1 + int(d.below(64));
    for (int i = 0; i < 96; ++i) {
      vec3 p =
          clearance::fma(step * real(i % columns), along, clearance::fma(step * real(i / columns), across, corner));
      if (patch % 4 == 1 && i % 7 == 0) p = p + d.point(extent, {0, 0, 0});  // strangers
      if (patch % 3 == 1 && i % 11 == 0) p.x = clearance::not_a_number;
      if (patch % 7 == 2) p = corner;
      points.push_back(p);
    }
  }
  return points;
}

/// In all scenes, with patches in order and with some of all points at random.
template <class V, class P, class Check>
void by_tangents_in_all_scenes(std::uint32_t width, std::uint32_t leaf_size, const Check& check) {
  dice d(78 + width + leaf_size);
  for (const auto& s : scenes<P>()) {
    const auto model = make_model<V>(s, {.width = width, .leaf_size = leaf_size}, clearance::wrapped{});
    auto points = patches(d, s.size);
    points.insert(points.end(), s.points.begin(), s.points.end());
    check(s, model, points, s.name, nothing_inside);
    std::shuffle(points.begin(), points.end(), std::mt19937(5));
    points.resize(points.size() / 4);
    check(s, model, points, s.name + ", at random", nothing_inside);
  }
}
template <class Check>
void by_tangents_to_spheres(const Check& check) {
  by_tangents_in_all_scenes<clearance::sphere, inner_sphere>(8, 4, check);
  by_tangents_in_all_scenes<clearance::aabb, inner_sphere>(4, 1, check);
  by_tangents_in_all_scenes<clearance::obb, inner_sphere>(8, 2, check);
}
template <class Check>
void by_tangents_to_triangles(const Check& check) {
  by_tangents_in_all_scenes<clearance::sphere, triangle>(8, 4, check);
  by_tangents_in_all_scenes<clearance::aabb, triangle>(2, 9, check);
  by_tangents_in_all_scenes<clearance::obb, triangle>(8, 4, check);
}

/// A robot of solids as primitives that a plain loop can ask.
template <class Model>
scene<triangle> primitives_of(const Model& model, std::vector<Eigen::Isometry3d> poses) {
  scene<triangle> s{"solids", {}, std::move(poses), {}};
  for (const auto& part : model.parts()) {
    s.parts.emplace_back(part.tree.primitives.size());
    for (std::size_t k = 0; k < part.tree.primitives.size(); ++k)
      s.parts.back()[part.tree.ids[k]] = part.tree.primitives[k];
  }
  return s;
}

/// Solids that overlap and repeat, from inside, on their faces and in their middles.
template <class Check>
void by_tangents_to_solids(const Check& check) {
  dice d(41);
  const auto model = clearance::make_model<clearance::obb>(std::vector(3, clearance::close_mesh(shapes::cube(1))));
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  const auto s = primitives_of(model, {here, here, d.pose(0.5)});
  auto points = patches(d, 2);
  for (int k = 0; k < 3000; ++k)
    points.push_back({real(d.below(9)) / 4 - 1, real(d.below(9)) / 4 - 1, real(k / 400) / 4 - 1});
  points.insert(points.end(), 200, vec3{0, 0, 0});
  check(s, model, points, "boxes, two of them the same",
        [&](std::uint32_t k, vec3 q) { return model.parts()[k].interior.view().inside(q); });
}

template <class Check>
void by_tangents_to_many_parts(const Check& check) {
  dice d(42);
  const scene<inner_sphere> s = many_parts(d);
  check(s, make_model<clearance::sphere>(s, {}, clearance::wrapped{}), patches(d, 1.5), "200 parts", nothing_inside);
}

}  // namespace testing
