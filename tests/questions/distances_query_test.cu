// SPDX-License-Identifier: BSD-3-Clause
// What a prepared question remembers changes no bit of its answer: cold, warm, moved, and after other clouds.
#include "solid/shapes.hpp"
#include "support/brute_distances.hpp"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/ray_image.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace distances_query_test {

using namespace testing;
using clearance::device, clearance::distances, clearance::host, clearance::placed, clearance::point_span;

namespace {

template <class Model, class Clouds>
void ask_often(const Model& on_host, std::vector<Eigen::Isometry3d> poses, const Clouds& clouds, verdict& v,
               const std::string& what) {
  const device gpu;
  const auto model = on_host.on(gpu);
  clearance::query query(gpu, model, clearance::distances{});
  const auto same = [&](const std::string& when, real d_max, bool which = true) {
    require_same(query(poses, clouds, {d_max, which}), ask(host{}, on_host, poses, clouds, distances{d_max, which}), v,
                 what + ", " + when);
  };
  same("cold", clearance::infinity);
  same("warm", clearance::infinity);
  poses[0].translation().x() += 0.01;
  same("moved a little, within 20 cm", 0.2f);
  same("the same, distances alone", clearance::infinity, false);
  poses.back().translation().z() -= 5;
  same("moved far", clearance::infinity);
  same("within nothing", 0);
  require_same(query(poses, point_span{}, {}), ask(host{}, on_host, poses, point_span{}, distances{}), v,
               what + ", no points");
  same("warm again, inside alone", -0.001f);
  same("warm again", clearance::infinity);
  query.forget();
  same("cold again", clearance::infinity);
}

template <class V, class P>
void ask_all_scenes() {
  verdict v;
  for (const auto& s : scenes<P>()) {
    const sources<P> all(s);
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const placed cloud{all.span, s.cloud_pose};
    ask_often(model, s.poses, cloud, v, s.name);
    ask_often(model, s.poses, std::tuple(placed{all.raw, all.camera_pose}, cloud), v, s.name + ", two clouds");
  }
}

}  // namespace

TEST_CASE("Warm distances to inner spheres are the cold ones") { ask_all_scenes<clearance::sphere, inner_sphere>(); }
TEST_CASE("Warm distances to triangles are the cold ones") { ask_all_scenes<clearance::aabb, triangle>(); }

TEST_CASE("Warm distances of points inside solids, and of equally near primitives, are the cold ones") {
  verdict v;
  dice d(97);
  const auto boxes = clearance::make_model<clearance::aabb>(std::vector(3, clearance::close_mesh(shapes::cube(1))));
  std::vector<vec3> points = d.points(4000, 3);
  for (int k = 0; k < 3000; ++k)
    points.push_back(
        {real(d.below(9)) - 4, real(d.below(9)) - 4, real(d.below(9)) - 4});  // on faces, edges and corners
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  ask_often(boxes, {here, here, d.pose(0.5)}, point_span(points), v, "boxes, two of them the same");
}

TEST_CASE("More parts than a kernel takes, and points that come and go: warm distances are the cold ones", "[slow]") {
  verdict v;
  dice d(98);
  const scene<inner_sphere> s = many_parts(d);
  const auto many = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  auto points = d.points(5000, 1.5);
  ask_often(many, s.poses, point_span(points), v, "200 parts");
  const device gpu;
  const auto there = many.on(gpu);
  clearance::query query(gpu, there, clearance::distances{});
  for (const std::size_t count : {1000, 5000, 33, 4999}) {
    std::ranges::shuffle(points, std::mt19937(unsigned(count)));
    for (std::size_t i = 0; i < count; i += 7) points[i].y = i % 2 == 0 ? clearance::not_a_number : real(i);
    const point_span some(points.data(), count);
    require_same(query(s.poses, some, {clearance::infinity, true}),
                 ask(host{}, many, s.poses, some, distances{clearance::infinity, true}), v,
                 std::to_string(count) + " points");
  }
}

TEST_CASE("A picture's pixels are taken in tiles, and each distance is at its own pixel") {
  verdict v;
  dice d(99);
  const device gpu;
  std::vector<clearance::inner_sphere> spheres;
  for (int k = 0; k < 300; ++k) spheres.push_back({d.point(0.4f), d.number(0.005, 0.05)});
  const auto model =
      clearance::make_model<clearance::sphere>(std::vector<std::vector<clearance::inner_sphere>>{spheres});
  const std::vector poses{d.pose(0.1)};
  Eigen::Isometry3d camera = Eigen::Isometry3d::Identity();
  camera.translation().z() = -1.5;
  for (const auto& [width, height] : {std::pair(64, 48), std::pair(40, 4), std::pair(8, 36), std::pair(65, 48),
                                      std::pair(64, 47), std::pair(12, 16)}) {
    std::vector<std::uint16_t> depth;
    for (int i = 0; i < width * height; ++i)
      depth.push_back(std::uint16_t(i % 11 == 0 ? 0 : 700 + 13 * (i % width) + 7 * (i / width)));
    const clearance::depth_image image(depth.data(), std::uint32_t(width), std::uint32_t(height),
                                       {50, 50, width / 2.0, height / 2.0});
    std::vector<clearance::ray> rays;
    for (int i = 0; i < width * height; ++i) rays.push_back({real(i % width) / 50 - 0.5f, real(i / width) / 50 - 0.5f});
    const auto rays_there = gpu.copy_in(std::span<const clearance::ray>(rays));
    const placed cloud{image, camera};
    const std::string what = std::to_string(width) + " x " + std::to_string(height);
    for (const real d_max : {real(0.3), clearance::infinity}) {
      const auto expected = ask(host{}, model, poses, cloud, distances{d_max, true});
      require_same(ask(gpu, model.on(gpu), poses, cloud, distances{d_max, true}), expected, v, what);
      const placed seen{clearance::ray_image(depth.data(), rays.data(), std::uint32_t(width), std::uint32_t(height)),
                        camera};
      const placed seen_there{
          clearance::ray_image(depth.data(), rays_there.data(), std::uint32_t(width), std::uint32_t(height)), camera};
      require_same(ask(gpu, model.on(gpu), poses, std::tuple(cloud, seen_there), distances{d_max, true}),
                   ask(host{}, model, poses, std::tuple(cloud, seen), distances{d_max, true}), v,
                   what + ", and with rays");
    }
  }
}

}  // namespace distances_query_test
