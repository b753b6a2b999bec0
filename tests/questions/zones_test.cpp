// SPDX-License-Identifier: BSD-3-Clause
// Points in zones are those of a plain loop over all points and primitives.
#include "support/brute_zones.hpp"
#include "support/question_laws.hpp"

#include <clearance/make_model.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace zones_test {

using namespace testing;
using clearance::host, clearance::point_span, clearance::zones;

TEST_CASE("Zones around inner spheres hold what all points and spheres say") {
  zones_cases cases;
  hold_in_all_scenes<clearance::sphere, inner_sphere>(cases, host{}, host{1});
  CHECK(cases.counted > 1000);
}
TEST_CASE("Zones around triangles hold what all points and triangles say") {
  zones_cases cases;
  hold_in_all_scenes<clearance::aabb, triangle>(cases, host{}, host{1});
  CHECK(cases.counted > 1000);
}

TEST_CASE(
    "A prepared question of zones says in every frame what one call says, and goes on after one that is refused") {
  zones_cases cases;
  hold_in_every_frame(cases, host{}, 5, 111);
}

TEST_CASE("What may be nearer by gap and tolerance is in the zone") {
  const std::vector<inner_sphere> ball{{{0, 0, 0}, 1}};
  const std::vector<vec3> points{{1.55f, 0, 0}, {1.45f, 0, 0}, {3, 0, 0}};
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const auto ask = [&](double gap, double tolerance) {
    const clearance::model robot{
        std::vector{clearance::make_part(clearance::build<clearance::sphere>(ball), gap, tolerance)}};
    return clearance::ask(host{}, robot, poses, point_span(points), zones{.thresholds = {0.3, 0.5}}).zones;
  };
  CHECK((ask(0, 0)[0].points == 0 && ask(0, 0)[1].points == 1));
  CHECK(
      (ask(0.04, 0.02)[1].points == 2 && ask(0.04, 0.02)[1].nearest_point == 1 && ask(0.04, 0.02)[1].first_point == 0));
  CHECK(ask(clearance::infinity, 0)[0].points == 3);  // without a certificate every point may be anywhere
}

TEST_CASE("The innermost zone, few points, no point, and what cannot be asked") {
  const std::vector<inner_sphere> ball{{{0, 0, 0}, 1}};
  const clearance::model robot{std::vector{clearance::make_part(clearance::build<clearance::sphere>(ball))}};
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const std::vector<vec3> points{{1.1f, 0, 0}, {1.4f, 0, 0}, {0, 1.4f, 0}, {9, 0, 0}};
  const auto ask = [&](const zones& options) {
    return clearance::ask(host{}, robot, poses, point_span(points), options);
  };
  CHECK(ask({.thresholds = {0.05, 0.2, 0.5}}).innermost() == 1);
  CHECK(ask({.thresholds = {0.05, 0.2, 0.5}, .min_points = 2}).innermost() == 2);
  CHECK(ask({.thresholds = {0.05, 0.2, 0.5}, .min_points = 4}).innermost() == 3);
  CHECK(clearance::ask(host{}, robot, poses, std::vector<vec3>{}, zones{.thresholds = {0.1}}).innermost() == 0);
  CHECK_THROWS_AS(ask({}), std::invalid_argument);
  CHECK_THROWS_AS(ask({.thresholds = {0.1}, .min_points = 0}), std::invalid_argument);
  clearance::zone one;
  clearance::point_counts counts;
  for (const zones& none : {zones{}, {.thresholds = {0.1}, .min_points = 0}}) {
    clearance::query query(host{}, robot, zones{{0.0}});
    CHECK_THROWS_AS(query(poses, point_span(points), none), std::invalid_argument);
    CHECK_THROWS_AS(query.enqueue(poses, point_span(points), none, {&one, &counts}), std::invalid_argument);
    CHECK_THROWS_AS(enqueue(host{}, robot, poses, point_span(points), none, {&one, &counts}), std::invalid_argument);
  }
  CHECK_THROWS_AS(ask({.thresholds = {0.2, 0.1}}), std::invalid_argument);
  CHECK_THROWS_AS(ask({.thresholds = {-0.1}}), std::invalid_argument);
  CHECK_THROWS_AS(ask({.thresholds = {clearance::not_a_number}}), std::invalid_argument);
  const clearance::model_view<decltype(robot)::view_type> no_parts{nullptr, {}, 0, 0};
  CHECK_THROWS_AS(clearance::ask(host{}, no_parts, std::span<const Eigen::Isometry3d>(), point_span(points),
                                 zones{.thresholds = {0.1}, .each_part = true}),
                  std::invalid_argument);
  CHECK(clearance::ask(host{}, no_parts, std::span<const Eigen::Isometry3d>(), point_span(points),
                       zones{.thresholds = {0.1}})
            .innermost() == 0);
  const clearance::model two{std::vector{robot.parts()[0], robot.parts()[0]}};
  CHECK_THROWS_AS(clearance::ask(host{}, two, std::vector(2, poses[0]), point_span(points),
                                 zones{.thresholds = {0.1, 0.2, 0.3}, .each_part = true}),
                  std::invalid_argument);
}

}  // namespace zones_test
