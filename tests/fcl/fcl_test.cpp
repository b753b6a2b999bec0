// SPDX-License-Identifier: BSD-3-Clause
// A second opinion from FCL, by those of its functions that are exact: spheres of radius 0 against sphere shapes, point
// by point and by its broad phase; and BVHModel<OBBRSS> of a mesh against one of points as degenerate triangles.
#include "support/brute_force.hpp"
#include "support/scenes.hpp"

#include <clearance/bvh/build.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/distance.h>

namespace fcl_test {

using namespace testing;

namespace {

using Eigen::Isometry3d, Eigen::Vector3d;
Vector3d wide_vector(vec3 p) { return {p.x, p.y, p.z}; }

/// The least distance as FCL's broad phase finds it; spheres that overlap a point are not its business.
double by_broad_phase(const std::vector<std::vector<inner_sphere>>& parts, const std::vector<Isometry3d>& poses,
                      const std::vector<vec3>& points) {
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;
  fcl::DynamicAABBTreeCollisionManagerd robot, cloud;
  const auto add = [&](auto& manager, double radius, const Vector3d& at) {
    objects.push_back(std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(radius),
                                                              Eigen::Matrix3d::Identity(), at));
    manager.registerObject(objects.back().get());
  };
  for (std::size_t k = 0; k < parts.size(); ++k)
    for (const inner_sphere& s : parts[k]) add(robot, s.radius, poses[k] * wide_vector(s.center));
  for (const vec3 p : points) add(cloud, 0, wide_vector(p));
  robot.setup();
  cloud.setup();
  fcl::DefaultDistanceData<double> data;
  robot.distance(&cloud, &data, fcl::DefaultDistanceFunction);
  return data.result.min_distance;
}

/// The least distance from points to triangles of positive area.
double by_meshes(const std::vector<triangle>& faces, const Isometry3d& pose, const std::vector<vec3>& points) {
  using mesh = fcl::BVHModel<fcl::OBBRSSd>;
  mesh solid, cloud;
  solid.beginModel();
  for (const triangle& t : faces)
    if (t.unit_normal != vec3{0, 0, 0}) solid.addTriangle(wide_vector(t.a), wide_vector(t.b), wide_vector(t.c));
  solid.endModel();
  cloud.beginModel();
  for (const vec3 p : points) {
    const Vector3d q = wide_vector(p);
    cloud.addTriangle(q, q + Vector3d(1e-10, 0, 0), q + Vector3d(0, 1e-10, 0));
  }
  cloud.endModel();
  fcl::DistanceRequestd request;
  fcl::DistanceResultd result;
  return fcl::distance(&solid, pose, &cloud, Isometry3d::Identity(), request, result);
}

/// Eight units in the last place of |p| + |t| + part size.
double tolerance(const Isometry3d& pose, double p, double size) {
  return 8 * 0x1p-23 * (p + pose.translation().norm() + size);
}

std::vector<vec3> outside(dice& d, std::size_t n, double nearest, double farthest) {
  std::vector<vec3> all(n);
  for (vec3& p : all) p = clearance::scaled(d.number(nearest, farthest), d.direction());
  return all;
}

}  // namespace

TEST_CASE("Sphere parts are as far as FCL's spheres are, sphere by sphere and point by point") {
  dice d(1);
  for (int round = 0; round < 40; ++round) {
    const auto spheres = random_spheres(d, 30, 0.5, 0.2);
    const Isometry3d pose = d.pose(1);
    const auto points = outside(d, 30, 3, 6);
    double least = infinity;
    for (const inner_sphere& s : spheres)
      for (const vec3 p : points) {
        const fcl::Sphered ball(s.radius), point(0);
        Isometry3d there = Isometry3d::Identity(), here = Isometry3d::Identity();
        there.translation() = pose * wide_vector(s.center);
        here.translation() = wide_vector(p);
        fcl::DistanceRequestd request;
        fcl::DistanceResultd result;
        least = std::min(least, fcl::distance(&ball, there, &point, here, request, result));
      }
    const auto r = clearance::ask(clearance::host{}, clearance::make_part(clearance::build<clearance::sphere>(spheres)),
                                  pose, points, clearance::min_distance{});
    CHECK(std::abs(r.distance - least) <= tolerance(pose, 6, 1.3));
    CHECK((r.lower <= least && least <= r.upper));
  }
}

TEST_CASE("Robots of sphere parts are as far from a cloud as FCL's broad phase says") {
  dice d(2);
  for (int round = 0; round < 15; ++round) {
    const std::vector<std::vector<inner_sphere>> parts = {
        random_spheres(d, 200, 0.4, 0.05), random_spheres(d, 1, 0.4, 0.3), random_spheres(d, 80, 0.2, 0.1)};
    const std::vector<Isometry3d> poses = {d.pose(0.5), d.pose(0.5), d.pose(0.5)};
    const auto points = outside(d, 2000, 2, 4);
    std::vector<decltype(clearance::make_part(clearance::build<clearance::aabb>(parts[0])))> own;
    for (const auto& p : parts) own.push_back(clearance::make_part(clearance::build<clearance::aabb>(p)));
    const auto r =
        clearance::ask(clearance::host{}, clearance::model(std::move(own)), poses, points, clearance::min_distance{});
    const double truth = by_broad_phase(parts, poses, points);
    CHECK(std::abs(r.distance - truth) <= tolerance(poses[r.part], 4, 1));
    CHECK((r.lower <= truth && truth <= r.upper));
  }
}

TEST_CASE("Triangle parts are as far from a cloud as FCL's meshes are") {
  dice d(3);
  for (int round = 0; round < 25; ++round) {
    auto faces = random_triangles(d, 300, 0.5, round % 2 ? 0.3 : 0.02);
    faces.push_back(triangle::from(faces[0].a, faces[0].a, faces[0].a));  // without area, on a corner: changes nothing
    const Isometry3d pose = d.pose(1);
    const auto points = outside(d, 1500, 2.8, 5);
    const double truth = by_meshes(faces, pose, points);
    const auto in_boxes =
        clearance::ask(clearance::host{}, clearance::make_part(clearance::build<clearance::obb>(faces)), pose, points,
                       clearance::min_distance{});
    const auto in_spheres =
        clearance::ask(clearance::host{}, clearance::make_part(clearance::build<clearance::sphere>(faces)), pose,
                       points, clearance::min_distance{});
    CHECK(std::abs(in_boxes.distance - truth) <= tolerance(pose, 5, 1) + 1e-10);
    CHECK(same_bits(in_boxes.distance, in_spheres.distance));
    CHECK((in_boxes.lower <= truth + 1e-10 && truth <= in_boxes.upper));
  }
}

TEST_CASE("Every single point of a cloud is as far from a mesh as FCL says") {
  dice d(4);
  const auto faces = random_triangles(d, 100, 0.5, 0.2);
  const auto part = clearance::make_part(clearance::build<clearance::aabb>(faces));
  const Isometry3d pose = d.pose(1);
  for (const vec3 p : d.points(200, 1.5)) {
    const double truth = by_meshes(faces, pose, {p});
    const auto r = clearance::ask(clearance::host{}, part, pose, std::vector<vec3>{p}, clearance::min_distance{});
    CHECK(std::abs(r.distance - truth) <= tolerance(pose, 3, 1) + 1e-10);
  }
}

}  // namespace fcl_test
