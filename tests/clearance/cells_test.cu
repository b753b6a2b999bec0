// SPDX-License-Identifier: BSD-3-Clause
// Cells that a device makes keep their laws, and distances that are looked up in cells are the host's without them.
#include "clearance/celled.hpp"
#include "clearance/fielded.hpp"
#include "frames/far_scenes.hpp"
#include "scan/tangent_scenes.hpp"
#include "support/frame_after_frame.hpp"
#include "support/held_stream.cuh"
#include "support/product_device.cuh"

#include <clearance/backends/device_buffer.cuh>
#include <clearance/chunked_query.hpp>
#include <clearance/device.cuh>
#include <clearance/near_maps.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/questions/distances.hpp>

namespace cells_device_test {

using namespace testing;
using clearance::cell_options, clearance::device, clearance::devices, clearance::distances, clearance::host,
    clearance::placed, clearance::point_span;

namespace {

/// The laws of cells that the device makes, and distances to a robot with them.
struct on_device {
  device gpu = {};
  cells_law<device> law{gpu};
  dice d{451};

  /// The robot with cells on the device; without them, if it is not `needed` that it has any.
  template <class Model>
  auto equip(const Model& bare, const cell_options& options, const std::string& what, bool needed = true) {
    const auto celled = law.equip(bare, what, options, needed);
    law.check(celled, d, what);
    return celled.on(gpu);
  }
  template <class Model, class Clouds>
  void operator()(const Model& bare, const std::vector<Eigen::Isometry3d>& poses, const Clouds& clouds, double size,
                  const cell_options& options, const std::string& what, bool needed = true) {
    require_same_distances(gpu, bare, equip(bare, options, what, needed), poses, clouds, size, law.v, what);
  }
};

/// Points along rows of a camera, as depths.
std::vector<std::uint16_t> depths(std::uint32_t width, std::uint32_t height) {
  std::vector<std::uint16_t> all;
  for (std::uint32_t i = 0; i < width * height; ++i)
    all.push_back(std::uint16_t(i % 11 == 0 ? 0 : 700 + 13 * (i % width) + 7 * (i / width)));
  return all;
}

}  // namespace

TEST_CASE("By cells to inner spheres: all scenes, points and images") {
  on_device check;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    const std::tuple clouds(placed{all.span, s.cloud_pose}, placed{all.raw, all.camera_pose});
    const auto bare = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    for (const double reach : {0.3, 5.0})
      check(bare, s.poses, clouds, s.size, {1 << 24, reach * s.size}, s.name + ", reach " + std::to_string(reach),
            s.name != "coincident");
  }
  CHECK((check.law.leaves[0] == 0 && check.law.leaves[1] > 1000 && check.law.ties > 1000));
}

TEST_CASE("By cells to triangles: all scenes, several clouds") {
  on_device check;
  for (const auto& s : scenes<triangle>()) {
    const sources<triangle> all(s);
    const std::vector clouds(2, placed{all.span, s.cloud_pose});
    const auto bare = make_model<clearance::obb>(s, {.width = 4, .leaf_size = 1}, clearance::wrapped{});
    for (const double reach : {0.3, 5.0})
      check(bare, s.poses, clouds, s.size, {1 << 26, reach * s.size}, s.name + ", reach " + std::to_string(reach),
            s.name != "coincident");
  }
  CHECK((check.law.leaves[1] > 1000 && check.law.ties > 1000));
}

namespace {

template <class V, class P>
void odd_ones() {
  on_device check;
  auto all = odd_parts<P>();
  all.push_back(equal_in_a_box<P>(100));
  all.push_back(equal_in_a_box<P>(300));
  for (const odd_part<P>& part : all) {
    const auto one = odd_model<V>(part);
    const double size = double(one.parts()[0].facts.radius);
    const auto& ball = one.parts()[0].facts;
    const clearance::model bare{std::vector(2, one.parts()[0])};
    const Eigen::Isometry3d here = shifted(-ball.center.x, -ball.center.y, -ball.center.z);
    auto points = scattered(check.d, 3000, 1.5 * size);
    for (int k = 0; k < 200; ++k)
      points.push_back(
          part.primitives[check.d.below(unsigned(part.primitives.size()))].nearest(check.d.point(size, ball.center)) -
          ball.center);
    const auto there = check.equip(bare, part.options, part.name);
    for (const auto& poses : {std::vector{here, here}, std::vector{here, check.d.pose(size) * here}})
      require_same_distances(check.gpu, bare, there, poses, placed{point_span(points), shifted(0, 0, 0)}, size,
                             check.law.v, part.name);
    require_no_change_of_pairs(check.gpu, bare, there, {here, check.d.pose(size) * here},
                               placed{point_span(points), shifted(0, 0, 0)}, size, check.law.v, part.name);
  }
  CHECK((check.law.leaves[0] > 500 && check.law.leaves[1] > 1000 && check.law.long_lists > 300));
}

}  // namespace

TEST_CASE("By cells to spheres that are hard to tell apart") { odd_ones<clearance::sphere, inner_sphere>(); }
TEST_CASE("By cells to triangles that are hard to tell apart") { odd_ones<clearance::obb, triangle>(); }

TEST_CASE("By cells to a primitive of somebody else's, near and in neighbours") {
  on_device check;
  const clearance::model bare{
      std::vector(2, clearance::make_part(clearance::build<clearance::obb>(rods(check.d)), 0, 0))};
  const auto points = patches(check.d, 1.5);
  check(bare, {shifted(0, 0, 0), shifted(0.1, 0.2, 0)}, point_span(points), 1, {1 << 24, 1}, "rods");
  CHECK((check.law.leaves[1] > 1000 && check.law.ties > 50));
}

TEST_CASE("Where all lists would be too long there are no cells, and distances are the same") {
  on_device check;
  const auto one = random_primitives<inner_sphere>(check.d, 1, 1, 0.3)[0];
  const clearance::model bare{
      std::vector{clearance::make_part(clearance::build<clearance::sphere>(std::vector(300, one)))}};
  const auto made = clearance::with_cells(check.gpu, bare, {1 << 22, 1});
  CHECK(made.without[0] == "4194304 bytes are too few for cells of its 300 primitives");
  CHECK(made.model.view().cells == nullptr);
  const auto points = scattered(check.d, 500, 1);
  require_same_distances(check.gpu, bare, made.model.on(check.gpu), {check.d.pose(0.1)}, point_span(points), 1,
                         check.law.v, "300 equal ones");
}

TEST_CASE("By cells to robots of extreme numbers") {
  on_device check;
  for (const auto& s : edge_scenes()) {
    if (std::ranges::any_of(s.parts, [](const auto& p) { return p.size() > 1000; })) continue;
    if (s.parts.size() > 20 && s.points.size() < 1000) continue;  // as those of more points
    check(make_model<clearance::sphere>(s, {}, clearance::wrapped{}), s.poses,
          placed{point_span(s.points), s.cloud_pose}, s.size, {1 << 24, 1}, s.name, false);
  }
  CHECK((check.law.with > 10 && check.law.without == 0));
}

TEST_CASE("By cells to robots and points that are far away") {
  on_device check;
  each_far_question<ball_body>(6, [&]<class Source>(const auto& robot, const auto& poses, const Source& source,
                                                    const truth& t, const std::string& name) {
    if constexpr (std::is_same_v<Source, point_span>)
      check(model_of(robot), poses, placed{source, t.pose}, 1, {1 << 22, 2}, name);
  });
  each_far_pose<box_body>(
      8, [&](const auto& robot, const auto& poses, const point_span& source, const truth& t, const std::string& name) {
        check(model_of(robot), poses, placed{source, t.pose}, 1, {1 << 22, 2}, name);
      });
}

TEST_CASE("By cells to solids: inside, outside, and signed") {
  on_device check;
  for (const double tolerance : {0.0, 0.3, 2.0}) {
    auto points = scattered(check.d, 5000, 1.5);
    for (int k = 0; k < 3000; ++k)  // on faces, edges and corners of a part that is there twice
      points.push_back({real(check.d.below(9)) / 4 - 1, real(check.d.below(9)) / 4 - 1, real(k / 400) / 4 - 1});
    const Eigen::Isometry3d here = shifted(0, 0, 0);
    const std::string what = "solids, tolerance " + std::to_string(tolerance);
    const auto bare = solid_robot(2, tolerance);
    const auto there = check.equip(bare, {1 << 24, 1 + tolerance}, what);
    for (const auto& poses : {std::vector{here, here}, std::vector{here, check.d.pose(0.5)}})
      require_same_distances(check.gpu, bare, there, poses, point_span(points), 1, check.law.v, what);
    require_no_change_of_pairs(check.gpu, bare, there, {here, check.d.pose(0.5), here, here}, point_span(points), 1,
                               check.law.v, what);
  }
  CHECK((check.law.leaves[2] > 50 && check.law.outside > 1000));
  const closed_parts parts = closed_scene(61);
  const auto bare = clearance::make_model<clearance::aabb>(parts.meshes);
  const auto points = scattered(check.d, 5000, 0.7);
  for (const double reach : {0.1, 4.0})
    check(bare, parts.poses, placed{point_span(points), check.d.pose(0.1)}, 0.5, {1 << 26, reach}, "closed meshes");
}

TEST_CASE("By cells: more parts than a kernel takes", "[slow]") {
  on_device check;
  const scene<inner_sphere> s = many_parts(check.d);
  const auto points = scattered(check.d, 5000, 1.5);
  const auto bare = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto celled = check.law.equip(bare, "200 parts", {1 << 21, 0.5});
  require_same_distances(check.gpu, bare, celled.on(check.gpu), s.poses, point_span(points), 1, check.law.v,
                         "200 parts");
}

TEST_CASE("By cells: a crowd, frame after frame") {
  on_device check;
  const scene<inner_sphere> s = crowd(455);
  const auto bare = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto there = check.equip(bare, {1 << 24, 1}, "a crowd");
  auto poses = s.poses;
  clearance::query query(check.gpu, there, distances{});
  const auto neighbours = patches(check.d, 0.5);
  const std::vector clouds{point_span(s.points), point_span(neighbours)};
  frame_after_frame(
      poses,
      [&](const std::string& when) {
        for (const double d_max : {0.1, double(infinity)}) {
          const distances q{d_max, true};
          require_same(query(poses, clouds, q), ask(host{}, bare, poses, clouds, q), check.law.v, when);
        }
      },
      [&] { query.forget(); });
}

TEST_CASE("By cells: a picture's pixels, in tiles and not, behind a cloud") {
  on_device check;
  const scene<inner_sphere> s = scenes<inner_sphere>()[0];
  const auto bare = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto points = scattered(check.d, 777, 2);
  for (const auto& [width, height] : {std::pair(64u, 48u), std::pair(40u, 4u), std::pair(8u, 36u), std::pair(65u, 48u),
                                      std::pair(64u, 47u), std::pair(3u, 1u)}) {
    const auto depth = depths(width, height);
    const clearance::depth_image image(depth.data(), width, height, {50, 50, width / 2.0, height / 2.0});
    check(bare, s.poses,
          std::tuple(placed{point_span(points), s.cloud_pose}, placed{image, s.poses[0] * shifted(0, 0, -1.5)}), 1,
          {1 << 24, 2}, std::to_string(width) + " x " + std::to_string(height));
  }
}

TEST_CASE("By cells and fields: distances are the same with both, in either order") {
  verdict v;
  dice d(452);
  const device gpu;
  const auto bare = solid_robot(2, 0);
  const auto fielded = clearance::with_fields(gpu, bare).model;
  const auto both = clearance::with_cells(gpu, fielded, {1 << 24, 2}).model;
  const auto turned = clearance::with_fields(gpu, clearance::with_cells(gpu, bare, {1 << 24, 2}).model).model;
  const std::vector poses{d.pose(0.5), d.pose(1.5)};
  const auto points = scattered(d, 5000, 2);
  for (const auto* robot : {&both, &turned}) {
    REQUIRE((robot->view().fields != nullptr && robot->view().cells != nullptr));
    require_same_distances(gpu, bare, robot->on(gpu), poses, point_span(points), 1, v, "fields and cells");
    require_no_change_of_pairs(gpu, bare, robot->on(gpu), poses, point_span(points), 1, v, "fields and cells");
  }
}

TEST_CASE("By cells in a stream that is held, and in a graph that is launched again", "[concurrent]") {
  verdict v;
  dice d(453);
  const own_stream stream;
  const device gpu{0, stream.handle};
  const scene<inner_sphere> s = scenes<inner_sphere>()[0];
  const auto bare = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto there = clearance::with_cells(gpu, bare, {1 << 24, 2}).model.on(gpu);
  const auto points = scattered(d, 5000, 2);
  const auto cloud = gpu.copy_in(std::span<const vec3>(points));
  const placed placed_there{point_span(cloud.data(), points.size()), s.cloud_pose};
  const auto expected = ask(host{1}, bare, s.poses, placed{point_span(points), s.cloud_pose}, distances{.which = true});
  clearance::pinned_buffer<real> distance(points.size(), 0);
  clearance::pinned_buffer<std::uint32_t> part(points.size(), 0), primitive(points.size(), 0);
  clearance::pinned_buffer<clearance::point_counts> counts(1, 0);
  clearance::query query(gpu, there, distances{});
  const distances::out out{{distance.data(), part.data(), primitive.data()}, counts.data()};
  const auto clear = [&] {
    std::fill_n(distance.data(), distance.size(), real(-1));
    std::fill_n(part.data(), part.size(), 77u), std::fill_n(primitive.data(), primitive.size(), 77u);
    *counts.data() = {};
  };
  const auto look = [&](const std::string& what) {
    gpu.wait();
    clearance::point_distances found = expected;
    found.distance.assign(distance.data(), distance.data() + distance.size());
    found.part.assign(part.data(), part.data() + part.size());
    found.primitive.assign(primitive.data(), primitive.data() + primitive.size());
    found.counts = *counts.data();
    require_same(found, expected, v, what);
    clear();
  };
  const auto once = [&] { clearance::enqueue(gpu, there, s.poses, placed_there, distances{.which = true}, out); };
  const auto prepared = [&] { query.enqueue(s.poses, placed_there, distances{.which = true}, out); };
  once();
  look("once");
  prepared();
  look("prepared");
  {
    gate held(stream.handle);
    once();
    v.require(cudaStreamQuery(stream.handle) == cudaErrorNotReady, "it has waited");
    held.release();
  }
  look("on a stream that was held");
  const captured_graph graph(stream.handle, once), again(stream.handle, prepared);
  for (int launch = 0; launch < 2; ++launch) {
    graph.launch();
    look("a graph, launch " + std::to_string(launch));
    again.launch();
    look("a prepared question's graph, launch " + std::to_string(launch));
  }
}

TEST_CASE("By cells: a cloud in chunks, and several devices") {
  verdict v;
  dice d(454);
  const device gpu;
  const devices several{0, 0};
  const auto bare = solid_robot(2, 0);
  const auto celled = clearance::with_cells(gpu, bare, {1 << 24, 1}).model;
  REQUIRE(!celled.cells().empty());
  const std::vector poses{d.pose(0.5), d.pose(1.5)};
  const auto points = scattered(d, 20000, 2);
  clearance::chunked cloud(point_span(points), 1 << 12);
  const auto there = celled.on(gpu);
  const auto on_each = celled.on(several);
  clearance::chunked_query query(gpu, there, distances{});
  for (const double d_max : {0.2, double(infinity)}) {
    const distances q{d_max, true};
    const auto expected = ask(host{1}, bare, poses, point_span(points), q);
    require_same(query(poses, cloud, Eigen::Isometry3d::Identity(), q), expected, v, "chunked");
    require_same(query(poses, cloud, Eigen::Isometry3d::Identity(), q), expected, v, "chunked, again");
    require_same(ask(several, on_each, poses, point_span(points), q), expected, v, "twice on one device");
    const clearance::signed_distances s{d_max, true};
    require_same(ask(several, on_each, poses, point_span(points), s), ask(host{1}, bare, poses, point_span(points), s),
                 v, "twice on one device, signed");
  }
}

}  // namespace cells_device_test
