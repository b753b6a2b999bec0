// SPDX-License-Identifier: BSD-3-Clause
// Certain facts: lower, upper and state; and points inside triangle parts.
#include "support/brute_force.hpp"
#include "support/scenes.hpp"

#include <clearance/bvh/build.hpp>
#include <clearance/frames/bracket.hpp>
#include <clearance/frames/margins.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace bracket_test {

using namespace testing;
using clearance::host, clearance::min_distance, clearance::min_distance_per_part, clearance::state;

namespace {

/// A ball of radius 1 at the origin of its part, whose solid is known up to `gap` and `tolerance`.
auto unit_ball(real gap, real tolerance = 0) {
  return clearance::make_part(clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{0, 0, 0}, 1}}), gap,
                              tolerance);
}
auto ask(real gap, real x, real tolerance = 0) {
  return ask(host{}, unit_ball(gap, tolerance), Eigen::Isometry3d::Identity(), std::vector<vec3>{{x, 0, 0}},
             min_distance{});
}

/// A cube of half edge 1 as triangles, and its inside.
struct cube_interior {
  CLEARANCE_HD bool inside(vec3 p) const {
    return clearance::absolute(p.x) < 1 && clearance::absolute(p.y) < 1 && clearance::absolute(p.z) < 1;
  }
};
std::vector<triangle> cube() {
  std::vector<triangle> all;
  for (int axis = 0; axis < 3; ++axis)
    for (const real side : {-1.0f, 1.0f}) {
      const auto corner = [&](real u, real w) {
        const real x[3] = {side, u, w};
        return vec3{x[(3 - axis) % 3], x[(4 - axis) % 3], x[(5 - axis) % 3]};
      };
      all.push_back(triangle::from(corner(-1, -1), corner(side, -side), corner(1, 1)));
      all.push_back(triangle::from(corner(-1, -1), corner(1, 1), corner(-side, side)));
    }
  return all;
}
auto cube_part(real tolerance = 0) {
  auto surface = clearance::make_part(clearance::build<clearance::obb>(cube(), {.leaf_size = 1}), 0, tolerance);
  return clearance::part<decltype(surface.tree), cube_interior>{surface.tree, {}, surface.facts};
}

}  // namespace

TEST_CASE("The bracket is the distance less the gap to the distance, rounded outward by the stated error") {
  const auto r = ask(0.5f, 3);
  CHECK(r.distance == 2);
  CHECK(r.lower < 1.5f);
  CHECK(r.lower > 1.4999f);
  CHECK(r.upper > 2);
  CHECK(r.upper < 2.0001f);
  CHECK(r.state == state::free);
  const auto wider = ask(0.5f, 3, 0.25f);
  CHECK(wider.distance == 2);
  CHECK(wider.lower == Approx(1.25).epsilon(1e-4));
  CHECK(wider.upper == Approx(2.25).epsilon(1e-4));
}

TEST_CASE("A search that stopped has as lower end what is certain there, and 0 if that is nothing") {
  const auto stopped = [](real d_max) {
    clearance::min_distance_result r;
    r.valid = 1;
    clearance::frames::beyond(r, d_max, 0.5, {0, 0});
    return r;
  };
  CHECK((stopped(2).lower > 1.4999f && stopped(2).lower <= 1.5f && stopped(2).state == state::free));
  for (const real d_max : {0.5f, 0.25f, 0.0f, -1.0f})
    CHECK((stopped(d_max).lower == 0 && stopped(d_max).state == state::possible));
  CHECK((stopped(0.25f).distance == infinity && stopped(0.25f).part == clearance::none));
  CHECK(stopped(infinity).state == state::no_data);
}

TEST_CASE("Floats of a bracket, and of what a margin makes of distances, are on the safe side of the doubles") {
  dice d(43);
  verdict v;
  for (int trial = 0; trial < 200; ++trial) {
    const clearance::frames::float_error error{d.uniform(0, 1e-3), d.uniform(0, 1e-3)};
    const clearance::part_facts facts{.radius = 1, .gap = d.number(0, 0.1), .tolerance = d.number(0, 0.1)};
    clearance::min_distance_result r;
    r.part = 0, r.distance = d.number(0.5, 2);
    const double lower = d.uniform(0.1, 0.5);
    clearance::frames::bracket(r, lower, facts.tolerance, false, error);
    v.require(r.lower <= lower && r.upper >= double(r.distance) + facts.tolerance + error.at(r.distance), "a bracket");
    for (const double margin : {d.uniform(0.2, 1), d.uniform(-1, -0.5)}) {
      const double most = clearance::frames::may_be_within(margin, facts, error);
      const double least = clearance::frames::is_within(margin, facts, error);
      // A hair for the quotient of doubles, which floats do not see.
      v.require(most - error.per_metre * std::abs(most) >= margin + facts.gap + facts.tolerance + error.here - 1e-15,
                "may be within ", margin);
      v.require(least + error.per_metre * std::abs(least) <= margin - facts.tolerance - error.here + 1e-15,
                "is within ", margin);
    }
  }
}

TEST_CASE("Facts that are no lengths certify nothing") {
  const auto slop = [](real gap, real tolerance) {
    return clearance::frames::slop({.radius = 1, .gap = gap, .tolerance = tolerance});
  };
  CHECK(slop(0.25f, 0.5f) == 0.75);
  for (const real none : {-0.1f, clearance::not_a_number, infinity})
    CHECK((slop(none, 0) == infinity && slop(0, none) == infinity));
}

TEST_CASE("A gap larger than the distance leaves only what is possible") {
  const auto r = ask(2.5f, 3);
  CHECK(r.lower == 0);
  CHECK(r.upper == Approx(2).epsilon(1e-4));
  CHECK(r.state == state::possible);
}

TEST_CASE("Without a certificate nothing but the upper end is claimed") {
  const auto r = ask(infinity, 3);
  CHECK(r.distance == 2);
  CHECK(r.lower == 0);
  CHECK(r.upper == Approx(2).epsilon(1e-4));
  CHECK(r.state == state::possible);
  CHECK(ask(infinity, 0.5f).state == state::collision);
}

TEST_CASE("A negative distance is a collision, and both ends of its bracket are 0") {
  const auto r = ask(0.25f, 0.25f);
  CHECK(r.distance == -0.75f);
  CHECK(r.lower == 0);
  CHECK(r.upper == 0);
  CHECK(r.state == state::collision);
  CHECK(r.normal == vec3{1, 0, 0});
}

TEST_CASE("A distance below 0 by less than the error, or by less than the tolerance, is only possible") {
  const auto rounding = ask(0, std::nextafter(1.0f, 0.0f));
  CHECK(rounding.distance < 0);
  CHECK(rounding.state == state::possible);
  CHECK(rounding.lower == 0);
  const auto touching = ask(0, 1);
  CHECK(touching.distance == 0);
  CHECK(touching.state == state::possible);
  CHECK(touching.lower == 0);
  const auto tolerated = ask(0, 0.95f, 0.1f);
  CHECK(tolerated.state == state::possible);
  CHECK(tolerated.lower == 0);
  CHECK(tolerated.upper == Approx(0.05).epsilon(1e-3));  // so far away may the true surface be
  CHECK(ask(0, 0.85f, 0.1f).state == state::collision);
}

TEST_CASE("The lower end is the least over all parts, not the winner's") {
  const auto robot = clearance::model(std::vector{unit_ball(0.125f), unit_ball(0.875f)});
  const std::vector<Eigen::Isometry3d> poses = {shifted(-2, 0, 0), shifted(2.25, 0, 0)};
  const std::vector<vec3> points = {{0, 0, 0}};
  // 1 to the first part, 1.25 to the second, which may reach as far as 0.375.
  const auto [each, minima] = ask(host{}, robot, poses, points, min_distance_per_part{});
  CHECK(each.part == 0);
  CHECK(each.distance == 1);
  CHECK(each.lower == Approx(0.375).epsilon(1e-4));
  CHECK(minima[1].distance == 1.25f);
  const auto shared = ask(host{}, robot, poses, points, min_distance{});
  CHECK((shared.part == 0 && shared.lower == each.lower));
  // One part without a certificate spoils it for all.
  const auto half = clearance::model(std::vector{unit_ball(0.125f), unit_ball(infinity)});
  CHECK(ask(host{}, half, poses, points, min_distance_per_part{}).all.lower == 0);
  CHECK(ask(host{}, half, poses, points, min_distance{}).lower == 0);
}

TEST_CASE("No valid point is no data, never far away") {
  for (const auto& points : {std::vector<vec3>{}, std::vector<vec3>(40, {0, clearance::not_a_number, 0}),
                             std::vector<vec3>(3, {0, 1e30f, 0})}) {
    const auto r = ask(host{}, unit_ball(0), Eigen::Isometry3d::Identity(), points, min_distance{});
    CHECK(r.state == state::no_data);
    CHECK(r.distance != r.distance);
    CHECK(r.lower == 0);
    CHECK(r.upper == infinity);
    CHECK((r.point == none && r.part == none && r.primitive == none && r.cloud == none));
    CHECK(r.seen == points.size());
    CHECK(r.valid == 0);
    CHECK(r.dropped[int(clearance::drop_reason::not_finite)] == points.size());
  }
  for (const state s : {state::free, state::possible, state::collision, state::no_data})
    CHECK(std::string(to_string(s)).size() > 3);
}

TEST_CASE("Of a list's distance nothing is certain below what the part and its errors may be off") {
  const clearance::distance_certainty off{{0.01, 0}, 0.1};
  CHECK(off.lower(0.05f) == 0);
  CHECK(off.lower(0.2f) == Approx(0.09));
  CHECK((off.lower(clearance::infinity) == 0 && off.lower(clearance::not_a_number) == 0));
  for (real d = 0.2f; d < 1; d += 0.01f)
    CHECK(double(off.lower(d)) <= clearance::frames::certain_distance(d, off.slop, off.error));
}

namespace {

/// One point that stands where a sensor says, which may be a fifth of its true distance away.
struct a_fifth_off {
  vec3 said;
  CLEARANCE_HD std::size_t size() const { return 1; }
  CLEARANCE_HD clearance::sample operator[](std::size_t) const { return {said}; }
  clearance::position_error rounding() const { return {0, 0.2}; }
};

}  // namespace

TEST_CASE("What a source may be off by far from its origin is in the bracket of what is near the robot") {
  const Eigen::Isometry3d pose(Eigen::Translation3d(10, 0, 0));  // the ball ends at 11
  const auto far = ask(host{}, unit_ball(0), pose, a_fifth_off{{12, 0, 0}}, min_distance{});
  CHECK(far.distance == 1);
  CHECK(far.upper >= 15 - 11);  // 15 less a fifth is 12
  CHECK(far.upper < 5);
  CHECK(far.lower == 0);  // 10 and a fifth is 12
}

TEST_CASE("A part that is one point has a bracket like any other") {
  const auto dot =
      clearance::make_part(clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{0, 0, 0}, 0}}), 0);
  const auto r = ask(host{}, dot, Eigen::Isometry3d::Identity(), std::vector<vec3>{{1, 0, 0}}, min_distance{});
  CHECK((r.distance == 1 && r.lower > 0.9999f && r.upper < 1.0001f));
}

TEST_CASE("A valid point inside a triangle part makes its distance 0, and certainly a collision if it is well inside") {
  const auto ask = [](vec3 p, real tolerance = 0) {
    return clearance::ask(host{}, cube_part(tolerance), Eigen::Isometry3d::Identity(), std::vector<vec3>{{5, 0, 0}, p},
                          min_distance{});
  };
  const auto deep = ask({0.5f, 0.25f, 0});
  CHECK(deep.distance == 0);
  CHECK((deep.lower == 0 && deep.upper == 0));
  CHECK(deep.state == state::collision);
  CHECK(deep.point == 1);
  CHECK(deep.nearest.x == Approx(1));
  CHECK(deep.normal == vec3{1, 0, 0});  // the way out
  const auto surface = ask({1, 0.25f, 0});
  CHECK(surface.distance == 0);
  CHECK(surface.state == state::possible);
  CHECK(surface.upper < 1e-4f);
  const auto barely = ask({std::nextafter(1.0f, 0.0f), 0.25f, 0});
  CHECK(barely.distance == 0);
  CHECK(barely.state == state::possible);
  CHECK(barely.upper < 1e-4f);
  CHECK(ask({0.75f, 0, 0}, 0.125f).state == state::collision);
  CHECK(ask({0.75f, 0, 0}, 0.375f).state == state::possible);
  const auto outside = ask({1.5f, 2, 0});
  CHECK(outside.distance == Approx(std::sqrt(0.25 + 1)));
  CHECK(outside.state == state::free);
}

TEST_CASE("Points inside triangle parts are brute force too, witness and ties included") {
  dice d(31);
  verdict v;
  const auto surface = cube_part();
  const auto robot = clearance::model(std::vector{surface, surface, surface});
  const std::vector<brute_part<triangle, cube_interior>> parts(3, {cube(), surface.facts, {}});
  for (int round = 0; round < 60; ++round) {
    // Far apart, overlapping, or two in one place.
    const std::vector<Eigen::Isometry3d> poses = {d.pose(round % 3 == 0 ? 1 : 4), shifted(3, 0, 0),
                                                  round % 2 ? shifted(3, 0, 0) : d.pose(3)};
    auto points = d.points(round % 4 == 0 ? 3000 : 200, round % 3 == 1 ? 8 : 4);
    for (std::size_t k = 0; k < 40; ++k)
      points.push_back({real(d.below(9)) / 2, real(d.below(5)) / 2 - 1, real(d.below(5)) / 2 - 1});
    const auto expected = brute_force(parts, poses, {brute_cloud(clearance::point_span(points))});
    require_equal(ask(host{}, robot, poses, points, min_distance{}), expected, v, "inside");
    const auto [r, minima] = ask(host{}, robot, poses, points, min_distance_per_part{});
    require_equal(r, expected, v, "inside, per part");
    require_equal(minima, expected, v, "inside");
    // A collision exactly if some point is inside by more than rounding, whichever point is the witness.
    bool deep = false;
    for (const vec3 p : points)
      for (const auto& pose : poses) {
        const auto q = oracle::moved_back(pose.matrix(), wider(p));
        deep = deep || std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)}) < 0.999L;
      }
    v.require(!deep || r.state == state::collision, "a point well inside is no collision");
    v.require(deep || r.state != state::collision || expected.best.distance == 0, "a collision without a point inside");
  }
}

}  // namespace bracket_test
