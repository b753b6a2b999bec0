// SPDX-License-Identifier: BSD-3-Clause
// Points in zones are those of a plain loop over all points and primitives.
#include "support/brute_zones.hpp"
#include "support/frames.hpp"

#include <clearance/make_model.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace zones_test {

using namespace testing;
using clearance::host, clearance::placed, clearance::point_span, clearance::zones;

namespace {

template <class V, class P>
void all_scenes() {
  verdict v;
  std::size_t counted = 0;
  for (const auto& s : scenes<P>()) {
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    const clouds one{two[0]};
    const std::vector<std::vector<double>> same(s.parts.size(), {0, 0.05 * s.size, 0.5 * s.size});
    std::vector<std::vector<double>> own;
    zones options{same[0]}, of_each{.thresholds = {}, .each_part = true};
    for (std::size_t k = 0; k < s.parts.size(); ++k) {
      own.push_back({0.1 * double(k + 1) * s.size, 0.3 * double(k + 1) * s.size});
      of_each.thresholds.insert(of_each.thresholds.end(), own[k].begin(), own[k].end());
    }
    const auto found = ask(host{}, model, s.poses, one, options);
    require_same(found, brute_zones(s, one, same), v, s.name);
    require_same(ask(host{1}, model, s.poses, two, options), brute_zones(s, two, same), v,
                 s.name + ", two clouds, one thread");
    require_same(ask(host{}, model, s.poses, two, of_each), brute_zones(s, two, own), v,
                 s.name + ", thresholds of each part");
    for (const auto& z : found.zones) counted += z.points;
  }
  CHECK(counted > 1000);
}

}  // namespace

TEST_CASE("Zones around inner spheres hold what all points and spheres say") {
  all_scenes<clearance::sphere, inner_sphere>();
}
TEST_CASE("Zones around triangles hold what all points and triangles say") { all_scenes<clearance::aabb, triangle>(); }

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

TEST_CASE(
    "A prepared question of zones says in every frame what one call says, and goes on after one that is refused") {
  verdict v;
  moving_frames f(5, 111);
  const auto model = f.model();
  clearance::query query(host{}, model, zones{{0.0}});
  for (; f.there(); f.next()) {
    const zones options{.thresholds = f.number % 2 ? std::vector{0.02, 0.3} : std::vector{0.0, 0.05, 0.4}};
    const auto expected = ask(host{}, model, f.s.poses, f.here(), options);
    const std::string what = "frame " + std::to_string(f.number);
    require_same(query(f.s.poses, f.here(), options), expected, v, what);
    clearance::zones_result enqueued = expected;
    std::fill(enqueued.zones.begin(), enqueued.zones.end(), clearance::zone{.points = 77});
    enqueued.counts = {};
    enqueued.per_part = options.per_part(f.s.parts.size());
    query.enqueue(f.s.poses, f.here(), options, {enqueued.zones.data(), &enqueued.counts});
    require_same(enqueued, expected, v, what + ", enqueued");
    v.require(
        enqueued.counts.valid == expected.counts.valid && expected.counts.valid + 1 >= moving_frames::sizes[f.number],
        what, ": counts");
    CHECK_THROWS_AS(query(f.s.poses, f.here(), {.thresholds = {0.2, 0.1}}), std::invalid_argument);
    CHECK_THROWS_AS(query(std::span(f.s.poses).first(4), f.here(), options), std::invalid_argument);
  }
}

}  // namespace zones_test
