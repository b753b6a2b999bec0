// SPDX-License-Identifier: BSD-3-Clause
// The prepared query says what the plain one says, in every bit: cold, warm, and after anything has moved.
#include "support/product_device.cuh"

#include <clearance/make_part.hpp>
#include <clearance/min_distance_query.cuh>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

using namespace testing;
using clearance::device, clearance::host, clearance::min_distance;

namespace {

/// Cold, warm, moved, and moved back; `source` is in host memory.
template <class Model, class S>
void ask_often(const Model& on_host, std::vector<Eigen::Isometry3d> poses, const S& source, const Eigen::Isometry3d& pose, verdict& v,
               const std::string& what) {
  const device gpu;
  const auto model = on_host.on(gpu);
  clearance::min_distance_query query(gpu, model);
  const auto same = [&](const std::string& when) {
    const auto expected = min_distance(host{}, on_host, poses, clearance::placed<S>{source, pose});
    v.require(same_result(query(poses, source, pose), expected), what + ", " + when, ": differs from the host's result");
  };
  same("cold");
  same("warm");
  poses[0].translation().x() += 0.01;
  same("moved a little");
  poses.back().translation().z() -= 5;
  same("moved far");
  query.forget();
  same("cold again");
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

clearance::triangle_mesh box(double half) {
  clearance::triangle_mesh m;
  for (int k = 0; k < 8; ++k) m.vertices.emplace_back(k & 1 ? half : -half, k & 2 ? half : -half, k & 4 ? half : -half);
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

std::vector<inner_sphere> ball_of_spheres(dice& d, int count) { return random_primitives<inner_sphere>(d, count, 0.3, 0.02); }

template <class V>
auto robot_of(dice& d, int parts, int spheres) {
  std::vector<clearance::part<clearance::bvh<V, inner_sphere>>> made;
  for (int k = 0; k < parts; ++k) made.push_back(clearance::make_part(clearance::build<V>(ball_of_spheres(d, spheres))));
  return clearance::model(std::move(made));
}

}  // namespace

TEST_CASE("The prepared query equals the plain one: spheres in spheres") { ask_all_scenes<inner_sphere, clearance::sphere>(); }
TEST_CASE("The prepared query equals the plain one: spheres in oriented boxes") { ask_all_scenes<inner_sphere, clearance::obb>(); }
TEST_CASE("The prepared query equals the plain one: triangles in boxes") { ask_all_scenes<triangle, clearance::aabb>(); }

TEST_CASE("Any number of parts and points is exact, even one and none") {
  dice d(5);
  verdict v;
  for (const int parts : {1, 7, 12, 13, 40}) {
    const auto model = robot_of<clearance::sphere>(d, parts, 50);
    std::vector<Eigen::Isometry3d> poses;
    for (int k = 0; k < parts; ++k) poses.push_back(d.pose(1));
    for (const int points : {0, 1, 31, 33, 127, 129, 2047, 2049, 30011}) {
      const auto cloud = d.points(std::size_t(points), 2);
      ask_often(model, poses, clearance::point_span(cloud), d.pose(0.1), v, std::to_string(parts) + " parts, " + std::to_string(points) + " points");
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
  ask_often(robot, poses, clearance::point_span(d.points(40000, 0.3)), here, v, "in the midst");
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
  std::vector<decltype(clearance::make_part<clearance::obb>(clearance::close_mesh(box(1))))> parts;
  for (const double half : {0.2, 0.3, 0.1}) parts.push_back(clearance::make_part<clearance::obb>(clearance::close_mesh(box(half)), {.tolerance = 1e-4}));
  const clearance::model robot(std::move(parts));
  const std::vector<Eigen::Isometry3d> poses = {d.pose(0.3), d.pose(0.3), d.pose(0.3)};
  for (const double half : {0.05, 0.5, 2.0}) {
    const auto cloud = d.points(5000, half);
    ask_often(robot, poses, clearance::point_span(cloud), shifted(0, 0, 0), v, "boxes, cloud of " + std::to_string(half));
  }
}

TEST_CASE("A query in a stream of its own leaves the caller's device alone, and refuses what does not fit") {
  dice d(8);
  const device gpu;
  const auto on_host = robot_of<clearance::sphere>(d, 2, 20);
  const auto model = on_host.on(gpu);
  clearance::min_distance_query query(gpu, model);
  const std::vector<Eigen::Isometry3d> poses = {d.pose(1), d.pose(1)};
  const auto cloud = d.points(100, 2);
  REQUIRE_THROWS_AS(query(std::span(poses).first(1), clearance::point_span(cloud)), std::invalid_argument);
  Eigen::Isometry3d skewed = poses[0];
  skewed.linear() *= 1.01;
  REQUIRE_THROWS_AS(query(std::vector{skewed, poses[1]}, clearance::point_span(cloud)), std::invalid_argument);
  REQUIRE(same_result(query(poses, clearance::point_span(cloud)), min_distance(host{}, on_host, poses, clearance::point_span(cloud))));
}
