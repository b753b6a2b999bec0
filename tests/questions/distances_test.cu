// SPDX-License-Identifier: BSD-3-Clause
// Packets of points on a device give what each point alone gives on the host; both give what brute force gives.
#include "solid/shapes.hpp"
#include "support/brute_distances.hpp"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace distances_test {

using namespace testing;
using clearance::device, clearance::distances, clearance::host, clearance::point_span;

namespace {

template <class V, class P>
void all_scenes(std::uint32_t width, bool layered = false) {
  verdict v;
  const device gpu;
  for (const auto& s : scenes<P>()) {
    const clearance::build_options build{.width = width, .leaf_size = width == 4 ? 1u : 4u};
    const auto model =
        layered ? make_model<V>(s, build, clearance::layered{}) : make_model<V>(s, build, clearance::wrapped{});
    hold_distances(gpu, s, model.on(gpu), v);
  }
}

}  // namespace

TEST_CASE("On a device every point's distance to inner spheres is the least of all") {
  all_scenes<clearance::sphere, inner_sphere>(8);
}
TEST_CASE("On a device every point's distance to triangles is the least of all") {
  all_scenes<clearance::aabb, triangle>(8);
  all_scenes<clearance::aabb, triangle>(4);
}
TEST_CASE("On a device every point's distance is the least of all in layered trees of two children") {
  all_scenes<clearance::obb, triangle>(2, true);
}

TEST_CASE("Walls, crowds, neighbours and strangers: every point's distance on a device is the host's", "[slow]") {
  verdict v;
  dice d(95);
  const device gpu;
  const auto boxes = clearance::make_model<clearance::aabb>(std::vector(2, clearance::close_mesh(shapes::cube(1))));
  const std::vector poses{d.pose(0.5), d.pose(0.5)};
  std::vector<vec3> wall, edge;
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 300; ++j)
      wall.push_back({1.5f + 0.001f * float(i % 7), 0.01f * float(i - 100), 0.01f * float(j - 150)});
  for (std::size_t i = 0; i < wall.size(); ++i)
    edge.push_back(i / 20 % 2 == 0 ? wall[i] : wall[wall.size() - 1 - i] + vec3{3, 0, 0});
  const std::vector<vec3> crowd = d.points(20000, 2);
  const auto there = boxes.on(gpu);
  for (const std::vector<vec3>* points : {&std::as_const(wall), &std::as_const(edge), &crowd})
    for (const real d_max : {real(0.3), clearance::infinity}) {
      const auto expected = ask(host{}, boxes, poses, point_span(*points), distances{d_max, true});
      require_same(ask(gpu, there, poses, point_span(*points), distances{d_max, true}), expected, v,
                   std::to_string(points->size()) + " points within " + std::to_string(d_max));
    }
  const scene<inner_sphere> s = many_parts(d);
  const auto many = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto some = d.points(5000, 1.5);
  for (const real d_max : {real(0.2), clearance::infinity})
    require_same(ask(gpu, many.on(gpu), s.poses, point_span(some), distances{d_max, true}),
                 ask(host{}, many, s.poses, point_span(some), distances{d_max, true}), v,
                 "200 parts within " + std::to_string(d_max));
}

}  // namespace distances_test
