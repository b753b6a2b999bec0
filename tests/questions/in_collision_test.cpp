// SPDX-License-Identifier: BSD-3-Clause
// Is a point within a margin, and which is the first? As a loop over all points and primitives says.
#include "support/brute_collision.hpp"
#include "support/question_laws.hpp"

#include <clearance/make_model.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace in_collision_test {

using namespace testing;
using clearance::host, clearance::in_collision, clearance::placed, clearance::point_span, clearance::state;

TEST_CASE("A point within a margin of inner spheres is found, the first that is certain") {
  collision_cases cases;
  hold_in_all_scenes<clearance::sphere, inner_sphere>(cases, host{}, host{1});
  CHECK((cases.count(state::free) > 5 && cases.count(state::collision) > 5));
}
TEST_CASE("A point within a margin of triangles is found, the first that is certain") {
  collision_cases cases;
  hold_in_all_scenes<clearance::aabb, triangle>(cases, host{}, host{1});
  CHECK((cases.count(state::free) > 5 && cases.count(state::collision) > 5));
}

TEST_CASE("What rounding leaves open of a depth is possible, too") {
  const std::vector<inner_sphere> ball{{{0, 0, 0}, 4}};
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const clearance::model robot{std::vector{clearance::make_part(clearance::build<clearance::sphere>(ball))}};
  verdict v;
  dice d(96);
  for (const vec3 p : d.points(200, 2)) {
    const std::vector<vec3> point{p};
    const double computed = ball[0].distance(p);
    const auto error = clearance::ask(host{}, robot, poses, point_span(point), clearance::distances{}).certain.error;
    const double off = error.at(real(computed));
    const auto ask = [&](double margin) {
      return clearance::ask(host{}, robot, poses, point_span(point), in_collision{{margin}}).state;
    };
    for (const double part : {0.2, 0.9, 0.999}) {
      v.require(ask(computed - part * off) == state::possible, computed, " m deep, margin less by ", part,
                " of its error: ", to_string(ask(computed - part * off)));
      v.require(ask(computed + part * off) == state::possible, computed, " m deep, margin more by ", part,
                " of its error");
    }
    v.require(ask(computed - 1.1 * off) == state::free && ask(computed + 1.1 * off) == state::collision, computed,
              " m deep: what is certain");
  }
}

TEST_CASE("What gap and tolerance leave open is possible, and no point says nothing") {
  const std::vector<inner_sphere> ball{{{0, 0, 0}, 1}};
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const std::vector<vec3> far{{3, 0, 0}, {1.5f, 0, 0}}, near{{1.2f, 0, 0}, {1.05f, 0, 0}};
  const auto ask = [&](double gap, double tolerance, const std::vector<vec3>& points, double margin) {
    const clearance::model robot{
        std::vector{clearance::make_part(clearance::build<clearance::sphere>(ball), gap, tolerance)}};
    return clearance::ask(host{}, robot, poses, point_span(points), in_collision{{margin}});
  };
  CHECK(ask(0, 0, far, 0.49).state == state::free);
  CHECK((ask(0.02, 0, far, 0.49).state == state::possible && ask(0.02, 0, far, 0.49).point == 1));
  CHECK((ask(0.02, 0, far, 0.51).state == state::collision && ask(0, 0.02, far, 0.51).state == state::possible));
  CHECK((ask(0.2, 0, near, 0.1).state == state::collision &&
         ask(0.2, 0, near, 0.1).point == 1));  // the first is only possible
  CHECK(ask(clearance::infinity, 0, far, 0).state == state::possible);
  CHECK(ask(0, 0, {}, 1).state == state::no_data);
  CHECK_THROWS_AS(ask(0, 0, far, clearance::not_a_number), std::invalid_argument);
  const clearance::model robot{std::vector{clearance::make_part(clearance::build<clearance::sphere>(ball))}};
  CHECK_THROWS_AS(clearance::ask(host{}, robot, poses, point_span(far), in_collision{{0.1, 0.2}}),
                  std::invalid_argument);
}

TEST_CASE("Of two pieces' answers the certain one counts, then the first, whichever is merged into the other") {
  const std::vector<inner_sphere> ball{{{0, 0, 0}, 1}};
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const clearance::model robot{std::vector{clearance::make_part(clearance::build<clearance::sphere>(ball), 0.3)}};
  verdict v;
  dice d(97);
  std::size_t states[4] = {};
  for (int trial = 0; trial < 100; ++trial) {
    const std::vector<vec3> all = d.points(6, 1.8);
    const auto ask = [&](std::uint32_t begin, std::uint32_t end) {
      auto r = clearance::ask(host{}, robot, poses, point_span(std::span(all).subspan(begin, end - begin)),
                              in_collision{{0.1}});
      if (r.cloud != clearance::none) r.point += begin;
      return r;
    };
    const auto whole = ask(0, 6);
    ++states[int(whole.state)];
    for (const std::uint32_t cut : {0u, 1u, 3u, 6u})
      for (const bool turned : {false, true}) {
        auto r = turned ? ask(cut, 6) : ask(0, cut);
        in_collision::merge(r, turned ? ask(0, cut) : ask(cut, 6));
        v.require(r.state == whole.state && r.cloud == whole.cloud && r.point == whole.point && r.part == whole.part &&
                      r.counts.valid == 6,
                  "cut at ", cut, turned ? ", turned: " : ": ", to_string(r.state), " of point ", r.point, " and not ",
                  to_string(whole.state), " of ", whole.point);
      }
  }
  CHECK((states[int(state::free)] > 5 && states[int(state::possible)] > 5 && states[int(state::collision)] > 5));
}

TEST_CASE("Of a robot without parts nothing is known, whatever is asked") {
  const std::vector<inner_sphere> ball{{{0, 0, 0}, 1}};
  const clearance::model robot{std::vector{clearance::make_part(clearance::build<clearance::sphere>(ball))}};
  const clearance::model_view<decltype(robot)::view_type> no_parts{nullptr, {}, 0, 0};
  const std::span<const Eigen::Isometry3d> no_poses;
  const std::vector<vec3> point{{1.5f, 0, 0}};
  const auto nearest = ask(host{}, no_parts, no_poses, point_span(point), clearance::min_distance{});
  const auto near = ask(host{}, no_parts, no_poses, point_span(point), in_collision{{0.1}});
  CHECK((nearest.state == state::no_data && nearest.valid == 1));
  CHECK((near.state == state::no_data && near.counts.valid == 1 && near.point == clearance::none));
}

TEST_CASE(
    "A prepared question of collision says in every frame what one call says, and goes on after one that is refused") {
  collision_cases cases;
  hold_in_every_frame(cases, host{}, 5, 113);
  CHECK((cases.count(state::free) > 0 && cases.count(state::collision) > 0 && cases.count(state::no_data) == 1));
}

}  // namespace in_collision_test
