// SPDX-License-Identifier: BSD-3-Clause
// The prepared query gives the plain one's answer, in every bit: cold, warm, and after anything has moved.
#include "solid/shapes.hpp"
#include "support/counted_memory.cuh"
#include "support/frame_after_frame.hpp"
#include "support/held_stream.cuh"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace query_test {

using namespace testing;
using clearance::device, clearance::host, clearance::min_distance;

namespace {

/// Cold, warm, moved, and moved back; `source` is in host memory.
template <class Model, class S>
void ask_often(const Model& on_host, std::vector<Eigen::Isometry3d> poses, const S& source,
               const Eigen::Isometry3d& pose, verdict& v, const std::string& what) {
  const device gpu;
  const auto model = on_host.on(gpu);
  clearance::query query(gpu, model, clearance::min_distance{});
  clearance::query per_part(gpu, model, clearance::min_distance_per_part{});
  const clearance::placed<S> cloud{source, pose};
  const auto same = [&](const std::string& when) {
    const auto expected = ask(host{}, on_host, poses, cloud, min_distance{});
    v.require(same_result(query(poses, source, pose), expected), what + ", " + when,
              ": differs from the host's result");
    const auto [robot, each] = clearance::ask(host{}, on_host, poses, cloud, clearance::min_distance_per_part{});
    const auto& found = per_part(poses, cloud);
    v.require(same_result(found.all, robot), what + ", " + when, ": differs from the host's result by parts");
    v.require(std::ranges::equal(found.parts, each, same_minimum), what + ", " + when, ": some part's minimum differs");
  };
  frame_after_frame(poses, same, [&] { query.forget(), per_part.forget(); });
}

template <class P, class V>
void ask_all_scenes() {
  verdict v;
  for (const auto& s : scenes<P>()) {
    const sources<P> all(s);
    for (const std::uint32_t width : {2, 4, 8}) {
      const auto model = make_model<V>(s, {.width = width, .leaf_size = width == 8 ? 4u : 11u}, clearance::wrapped{});
      const std::string what = s.name + ", width " + std::to_string(width);
      ask_often(model, s.poses, all.span, s.cloud_pose, v, what + ", span");
      if (width != 8) continue;
      ask_often(model, s.poses, all.floats, s.cloud_pose, v, what + ", floats");
      ask_often(model, s.poses, all.raw, all.camera_pose, v, what + ", 16-bit image");
    }
  }
}

std::vector<inner_sphere> ball_of_spheres(dice& d, int count) {
  return random_primitives<inner_sphere>(d, count, 0.3, 0.02);
}

template <class V>
auto robot_of(dice& d, int parts, int spheres) {
  std::vector<clearance::part<clearance::bvh<V, inner_sphere>>> made;
  for (int k = 0; k < parts; ++k)
    made.push_back(clearance::make_part(clearance::build<V>(ball_of_spheres(d, spheres))));
  return clearance::model(std::move(made));
}

}  // namespace

TEST_CASE("The prepared query equals the plain one: spheres in spheres") {
  ask_all_scenes<inner_sphere, clearance::sphere>();
}
TEST_CASE("The prepared query equals the plain one: spheres in oriented boxes") {
  ask_all_scenes<inner_sphere, clearance::obb>();
}
TEST_CASE("The prepared query equals the plain one: triangles in boxes") {
  ask_all_scenes<triangle, clearance::aabb>();
}

TEST_CASE("Any number of parts and points is exact, even one and none") {
  dice d(5);
  verdict v;
  for (const int parts : {1, 7, 12, 13, 64, 128}) {
    const auto model = robot_of<clearance::sphere>(d, parts, parts > 13 ? 9 : 50);
    std::vector<Eigen::Isometry3d> poses;
    for (int k = 0; k < parts; ++k) poses.push_back(d.pose(1));
    for (const int points : {0, 1, 15, 17, 31, 33, 2047, 2049, 30011}) {
      if (parts > 13 && points % 16 != 1) continue;
      const auto cloud = d.points(std::size_t(points), 2);
      ask_often(model, poses, clearance::point_span(cloud), d.pose(0.1), v,
                std::to_string(parts) + " parts, " + std::to_string(points) + " points");
      if (points > 1)  // an odd address: no wide loads
        ask_often(model, poses, clearance::point_span(cloud.data() + 1, cloud.size() - 1), d.pose(0.1), v, "unaligned");
    }
  }
}

TEST_CASE("Crowds stay exact: every point near, every point inside, every point equally far, every point invalid") {
  dice d(6);
  verdict v;
  const auto robot = robot_of<clearance::sphere>(d, 3, 3000);
  const std::vector<Eigen::Isometry3d> poses = {shifted(0, 0, 0), shifted(0.1, 0, 0), shifted(0, 0.1, 0)};
  const Eigen::Isometry3d here = shifted(0, 0, 0);
  const auto midst = d.points(40000, 0.3);
  ask_often(robot, poses, clearance::point_span(midst), here, v, "in the midst");
  std::vector<vec3> shell;
  for (int k = 0; k < 40000; ++k) shell.push_back(clearance::scaled(0.8f, d.direction()));
  ask_often(robot, poses, clearance::point_span(shell), here, v, "shell");
  const std::vector<vec3> same(20000, vec3{0.5f, 0.4f, 0.3f});
  ask_often(robot, poses, clearance::point_span(same), here, v, "one place");
  const std::vector<vec3> nothing(5000, vec3{clearance::not_a_number, 0, 0});
  ask_often(robot, poses, clearance::point_span(nothing), here, v, "nothing");
}

TEST_CASE("Points inside triangle parts are found by the prepared query too") {
  dice d(7);
  verdict v;
  std::vector<decltype(clearance::make_part<clearance::obb>(clearance::close_mesh(shapes::cube(1))))> parts;
  for (const double half : {0.2, 0.3, 0.1})
    parts.push_back(
        clearance::make_part<clearance::obb>(clearance::close_mesh(shapes::cube(half)), {.tolerance = 1e-4}));
  const clearance::model robot(std::move(parts));
  const std::vector<Eigen::Isometry3d> poses = {d.pose(0.3), d.pose(0.3), d.pose(0.3)};
  for (const double half : {0.05, 0.5, 2.0}) {
    const auto cloud = d.points(5000, half);
    ask_often(robot, poses, clearance::point_span(cloud), shifted(0, 0, 0), v,
              "boxes, cloud of " + std::to_string(half));
  }
}

TEST_CASE("Several clouds share one frame's bounds; empty and blind ones are counted") {
  dice d(9);
  verdict v;
  const device gpu;
  const auto on_host = robot_of<clearance::sphere>(d, 5, 60);
  const auto model = on_host.on(gpu);
  clearance::query query(gpu, model, clearance::min_distance{});
  clearance::query per_part(gpu, model, clearance::min_distance_per_part{});
  std::vector<Eigen::Isometry3d> poses;
  for (int k = 0; k < 5; ++k) poses.push_back(d.pose(1));
  const std::vector<vec3> blind(300, vec3{clearance::not_a_number, 0, 0}), none;
  std::vector<std::vector<vec3>> data = {d.points(5000, 3), none, blind, d.points(20000, 2), d.points(1, 2)};
  std::vector<clearance::placed<clearance::point_span>> clouds;
  for (const auto& points : data) clouds.push_back({clearance::point_span(points), d.pose(0.2)});
  for (int rotation = 0; rotation < 5; ++rotation, std::rotate(clouds.begin(), clouds.begin() + 1, clouds.end()))
    for (const char* when : {"first", "again"}) {
      const auto [robot, each] = clearance::ask(host{}, on_host, poses, clouds, clearance::min_distance_per_part{});
      v.require(same_result(query(poses, clouds), ask(host{}, on_host, poses, clouds, min_distance{})),
                std::to_string(rotation) + when, ": differs");
      const auto& found = per_part(poses, clouds);
      v.require(same_result(found.all, robot), std::to_string(rotation) + when, ": differs by parts");
      v.require(std::ranges::equal(found.parts, each, same_minimum), std::to_string(rotation) + when,
                ": some part's minimum differs");
    }
  const std::vector<clearance::placed<clearance::point_span>> no_cloud;
  REQUIRE(same_result(query(poses, no_cloud), ask(host{}, on_host, poses, no_cloud, min_distance{})));
  // What was enqueued before a cloud is refused leaves nothing behind: the near points are in the first cloud alone.
  auto near = clouds;
  std::ranges::sort(near, std::greater{}, [](const auto& cloud) { return cloud.source.size(); });
  near.resize(2);
  near[1].pose.linear() *= 1.01;
  const std::vector<vec3> apart(5000, vec3{50, 0, 0});
  const clearance::placed<clearance::point_span> far{clearance::point_span(apart), d.pose(0.2)};
  const auto expected = ask(host{}, on_host, poses, far, min_distance{});
  for (int k = 0; k < 3; ++k) {
    REQUIRE_THROWS_AS(query(poses, near), std::invalid_argument);
    REQUIRE(same_result(query(poses, far), expected));
  }
}

TEST_CASE(
    "A frame in the caller's graph reads poses from memory when it runs, and is the frame of those poses in every "
    "bit") {
  dice d(10);
  verdict v;
  const own_stream stream;
  const device gpu{.stream = stream.handle};
  const auto on_host = robot_of<clearance::sphere>(d, 14, 60);
  const auto model = on_host.on(gpu);
  clearance::query query(gpu, model, clearance::min_distance_per_part{});
  const auto points = d.points(30000, 2);
  const auto there = gpu.copy_in(std::span<const vec3>(points));
  const clearance::point_span view(there.data(), points.size());
  const clearance::pinned_buffer<clearance::world_transform> poses(15, gpu.id);
  const clearance::pinned_buffer<clearance::min_distance_result> result(1, gpu.id);
  const clearance::pinned_buffer<clearance::part_minimum> minima(14, gpu.id);
  const captured_graph graph(stream.handle, [&] {
    query.enqueue(poses.data(), view, poses.data() + 14,
                  clearance::min_distance_per_part::out{result.data(), minima.data()});
  });
  const auto run = [&] {
    graph.launch();
    gpu.wait();
  };
  for (int k = 0; k < 10; ++k) {
    std::vector<Eigen::Isometry3d> at;
    for (int part = 0; part < 15; ++part) {
      at.push_back(d.pose(1));
      if (k > 4) at.back().linear() *= 1 + 1e-6;  // rigid enough; both sides make the same of it
      poses.data()[part] = clearance::world_transform(at.back());
    }
    run();
    const clearance::placed cloud{clearance::point_span(points), at[14]};
    const auto [robot, each] =
        clearance::ask(host{}, on_host, std::span(at).first(14), cloud, clearance::min_distance_per_part{});
    v.require(same_result(*result.data(), robot), "replay " + std::to_string(k), ": differs from the host's result");
    v.require(std::ranges::equal(std::span(minima.data(), 14), each, same_minimum), "replay " + std::to_string(k),
              ": some part's minimum differs");
  }
  poses.data()[3].m[1][1] = 2;
  run();
  CHECK(result.data()->state == clearance::state::possible);
  CHECK(std::isnan(result.data()->distance));
  CHECK(result.data()->lower == 0);
  CHECK(minima.data()[0].point == clearance::none);
}

TEST_CASE("A prepared query takes its memory from the caller's resource, and none after its first frame") {
  dice d(11);
  const device gpu;
  const auto on_host = robot_of<clearance::sphere>(d, 3, 20);
  const auto model = on_host.on(gpu);
  const auto cloud = d.points(3000, 2);
  const std::vector<Eigen::Isometry3d> poses = {d.pose(1), d.pose(1), d.pose(1)};
  counted_memory memory;
  {
    clearance::query query(gpu, model, clearance::min_distance{}, &memory);
    REQUIRE(same_result(query(poses, cloud), ask(host{}, on_host, poses, cloud, min_distance{})));
    REQUIRE(memory.held > 3000 * sizeof(vec3));  // the cloud's copy too
    const std::size_t first = memory.most;
    for (int k = 0; k < 3; ++k)
      REQUIRE(same_result(query(poses, cloud), ask(host{}, on_host, poses, cloud, min_distance{})));
    REQUIRE(memory.most == first);
  }
  REQUIRE(memory.held == 0);
}

TEST_CASE("Points in pinned memory are found where they are, and where they have become others") {
  dice d(13);
  const device gpu;
  const auto on_host = robot_of<clearance::sphere>(d, 3, 60);
  const auto model = on_host.on(gpu);
  clearance::query query(gpu, model, clearance::min_distance{});
  const std::vector<Eigen::Isometry3d> poses = {d.pose(1), d.pose(1), d.pose(1)};
  const clearance::pinned_buffer<vec3> pinned(3000, gpu.id);
  verdict v;
  for (const char* when : {"first", "other points", "others again"}) {
    const auto points = d.points(pinned.size(), 2);
    std::copy(points.begin(), points.end(), pinned.data());
    v.require(same_result(query(poses, clearance::point_span(pinned.data(), pinned.size())),
                          ask(host{}, on_host, poses, points, min_distance{})),
              when, ": differs from the host's result");
  }
}

TEST_CASE("A query in a stream of its own leaves the caller's device alone, and refuses what does not fit") {
  dice d(8);
  const device gpu;
  const auto on_host = robot_of<clearance::sphere>(d, 2, 20);
  const auto model = on_host.on(gpu);
  clearance::query query(gpu, model, clearance::min_distance{});
  const std::vector<Eigen::Isometry3d> poses = {d.pose(1), d.pose(1)};
  const auto cloud = d.points(100, 2);
  REQUIRE_THROWS_AS(query(std::span(poses).first(1), clearance::point_span(cloud)), std::invalid_argument);
  clearance::query per_part(gpu, model, clearance::min_distance_per_part{});
  REQUIRE_THROWS_AS(per_part(std::span(poses).first(1), cloud), std::invalid_argument);
  const std::vector<clearance::part_minimum> three(3);
  REQUIRE_THROWS_AS(ask(gpu, model, poses, cloud, clearance::part_witnesses{three}), std::invalid_argument);
  Eigen::Isometry3d skewed = poses[0];
  skewed.linear() *= 1.01;
  REQUIRE_THROWS_AS(query(std::vector{skewed, poses[1]}, clearance::point_span(cloud)), std::invalid_argument);
  REQUIRE(same_result(query(poses, clearance::point_span(cloud)),
                      ask(host{}, on_host, poses, clearance::point_span(cloud), min_distance{})));
}

}  // namespace query_test
