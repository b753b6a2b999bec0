// SPDX-License-Identifier: BSD-3-Clause
// The nearest confirmed point is the first, after sorting, with enough others around it.
#include "solid/shapes.hpp"
#include "support/brute_support.hpp"
#include "support/question_laws.hpp"

#include <clearance/make_model.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/solid/close_mesh.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace min_distance_supported_test {

using namespace testing;
using clearance::host, clearance::min_distance_supported, clearance::point_span;

namespace {

template <class V, class P>
void all_scenes() {
  supported_cases cases;
  hold_in_all_scenes<V, P>(cases, host{});
  CHECK((cases.isolated > 1000 && cases.confirmed > 20));
  verdict v;
  for (const auto& s : scenes<P>()) {
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    const auto least = clearance::ask(host{}, model, s.poses, two, clearance::min_distance{});
    for (const min_distance_supported& q : cases.of_scene(s)) {
      if (q.min_points != 1) continue;
      const auto r = ask(host{}, model, s.poses, two, q);
      v.require(same_bits(r.distance, least.distance) && r.cloud == least.cloud && r.point == least.point &&
                    r.part == least.part && r.primitive == least.primitive && r.counts.valid == least.valid,
                s.name, ": one point confirms itself");
    }
  }
}

const clearance::model robot{std::vector{
    clearance::make_part(clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{0, 0, 0}, 1}}), 0.05)}};
const std::vector poses{Eigen::Isometry3d::Identity()};

}  // namespace

TEST_CASE("The nearest point of spheres that others confirm is the first of all") {
  all_scenes<clearance::sphere, inner_sphere>();
}
TEST_CASE("The nearest point of triangles that others confirm is the first of all") {
  all_scenes<clearance::aabb, triangle>();
}

TEST_CASE("Points counted one by one, as kernels do, are those within the radius") {
  namespace pairwise = clearance::pairwise;
  dice d(12);
  const auto points = d.points(400, 1, {2, -3, 1});
  const clearance::world_transform world_from_cloud(d.pose(4));
  const double radius = 0.4;
  std::vector<clearance::position> at;
  std::vector<clearance::ball> near;
  for (std::size_t c = 0; c < 5; ++c) {
    at.push_back(world_from_cloud(points[7 * c]));
    near.push_back(pairwise::around(at[c], radius, world_from_cloud).near);
  }
  std::vector<std::uint32_t> support(at.size(), 0);
  const pairwise::count_support<point_span> count{points,
                                                  world_from_cloud,
                                                  clearance::sphere::fit(near).as_ball(),
                                                  near.data(),
                                                  at.data(),
                                                  support.data(),
                                                  std::uint32_t(at.size()),
                                                  1000,
                                                  radius * radius};
  for (std::size_t i = 0; i < points.size(); ++i) count(i);
  for (std::size_t c = 0; c < at.size(); ++c) {
    const auto within = std::count_if(points.begin(), points.end(), [&](vec3 p) {
      const clearance::position q = world_from_cloud(p);
      return std::hypot(q.x - at[c].x, q.y - at[c].y, q.z - at[c].z) <= radius;
    });
    CHECK(within > 1);
    CHECK(support[c] == std::uint32_t(within));
  }
}

TEST_CASE("A grain of dust is told apart from a wall, whichever camera sees it") {
  std::vector<vec3> points{{1.02f, 0, 0}, {0, 1.5f, 0}, {3, 0, 0}, {3, 0.01f, 0}, {clearance::not_a_number, 0, 0}};
  const std::vector<vec3> other{{3, 0, 0.01f}};
  const auto ask = [&](std::uint32_t n, std::size_t most = 4096) {
    return clearance::ask(host{}, robot, poses, std::tuple(points, other),
                          min_distance_supported{.min_points = n, .radius = 0.0141f, .most = most});
  };
  const auto wall = ask(3);
  CHECK((wall.state == clearance::state::free && wall.point == 2 && wall.cloud == 0 && wall.distance == 2 &&
         wall.lower > 1.94f && wall.lower < 1.951f));
  CHECK((wall.isolated == 2 && wall.nearest_isolated.point == 0 && wall.nearest_isolated.distance < 0.021f &&
         wall.counts.valid == 5));
  CHECK(ask(1).state == clearance::state::possible);  // the dust may be in the gap
  const auto nobody = ask(4);
  CHECK((nobody.state == clearance::state::possible && nobody.distance == clearance::infinity && nobody.lower == 0 &&
         nobody.isolated == 5));
  const auto few = ask(3, 2);
  CHECK((few.state == clearance::state::possible && few.distance != few.distance && few.cloud == clearance::none &&
         few.isolated == 2));
  CHECK(clearance::ask(host{}, robot, poses, std::vector<vec3>{}, min_distance_supported{}).state ==
        clearance::state::no_data);
  points = {{0.5f, 0, 0}, {0.51f, 0, 0}, {0.5f, 0, 0}};
  CHECK(ask(3).state == clearance::state::collision);
}

TEST_CASE("What confirms nothing is refused") {
  const auto ask = [](const min_distance_supported& options) {
    return clearance::ask(host{}, robot, poses, std::vector<vec3>{{2, 0, 0}}, options);
  };
  CHECK_THROWS_AS(ask({.min_points = 0}), std::invalid_argument);
  CHECK_THROWS_AS(ask({.radius = -1}), std::invalid_argument);
  CHECK_THROWS_AS(ask({.radius = double(clearance::not_a_number)}), std::invalid_argument);
  CHECK_THROWS_AS(ask({.radius = double(clearance::infinity)}), std::invalid_argument);
  CHECK_THROWS_AS(ask({.most = 0}), std::invalid_argument);
  CHECK(ask({.most = 1 << 20}).state == clearance::state::possible);
  CHECK_THROWS_AS(ask({.most = (1 << 20) + 1}), std::invalid_argument);  // though one point is never so many
}

TEST_CASE("Prepared, the nearest confirmed point is in every frame what one call says, and after one that is refused") {
  supported_cases cases;
  hold_in_every_frame(cases, host{}, 5, 115);
}

TEST_CASE("More points than there are confirm nothing, which is known at once") {
  verdict v;
  dice d(117);
  scene<inner_sphere> s;
  s.parts = {{{{0, 0, 0}, 0.5f}}, {{{0.2f, 0, 0}, 0.25f}}}, s.poses = {shifted(0, 0, 0), shifted(0.125, 0, 0)};
  for (int i = 0; i < 500; ++i) s.points.push_back(clearance::scaled(d.number(1, 3), d.direction()));
  s.points.push_back({clearance::not_a_number, 0, 0});
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const clouds cloud{{point_span(s.points)}};
  for (const std::uint32_t n : {1u, 2u, 499u, 500u, 501u, 502u, 4'000'000'000u})
    for (const double radius : {0.5, 5.9, 10.0}) {
      const min_distance_supported options{.min_points = n, .radius = radius, .most = 8};
      const auto r = ask(host{}, model, s.poses, cloud, options);
      const auto expected = brute_support(s, cloud, {.min_points = n, .radius = radius});
      const std::string what = std::to_string(n) + " within " + std::to_string(radius);
      if (n > 500 || expected.isolated < 8)
        require_same(r, expected, v, what);
      else
        v.require(r.distance != r.distance && r.isolated == 8 && r.state == clearance::state::possible, what,
                  ": more than the nearest were asked");
    }
}

TEST_CASE("As many points are asked as are to be, however many parts are near each") {
  dice d(118);
  scene<inner_sphere> s;
  for (int k = 0; k < 40; ++k)
    s.parts.push_back({{{0, 0, 0.01f * float(k)}, 0.2f}}),
        s.poses.push_back(shifted(0, 0, 0));  // all are near all points
  for (int i = 0; i < 300; ++i) s.points.push_back(clearance::scaled(1 + 0.01f * float(i), d.direction()));
  const vec3 last = s.points.back();
  s.points.push_back(last);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const clouds cloud{{point_span(s.points)}};
  const auto whole = brute_support(s, cloud, {.min_points = 2, .radius = 0});
  REQUIRE((whole.point == 299 && whole.isolated > 100));
  for (const std::size_t most : {std::size_t(1), std::size_t(17), std::size_t(whole.isolated),
                                 std::size_t(whole.isolated + 1), std::size_t(4096)}) {
    const auto r =
        ask(host{}, model, s.poses, cloud, min_distance_supported{.min_points = 2, .radius = 0, .most = most});
    INFO(most);
    CHECK(r.isolated == std::min<std::size_t>(most, whole.isolated));
    CHECK((r.point == whole.point) == (most > whole.isolated));
  }
}

TEST_CASE(
    "A confirmed point that is certainly inside is a collision, as for min_distance, even behind others that are not "
    "certain") {
  const auto cube = clearance::make_part<clearance::aabb>(clearance::close_mesh(shapes::box({-1, -1, -1}, {1, 1, 1})),
                                                          {.tolerance = 0.1});
  const clearance::model solid{std::vector{cube}};
  std::vector<vec3> points(600, vec3{0.95f, 0, 0});  // inside, but by less than the tolerance
  const auto ask = [&](std::uint32_t n) {
    return clearance::ask(host{}, solid, poses, points, min_distance_supported{.min_points = n, .radius = 0.001});
  };
  CHECK((ask(3).state == clearance::state::possible && ask(3).distance == 0 && ask(3).point == 0));
  points.push_back({0.5f, 0, 0});
  REQUIRE(clearance::ask(host{}, solid, poses, points, clearance::min_distance{}).state == clearance::state::collision);
  CHECK(ask(2).state == clearance::state::possible);  // it is alone
  points.push_back({0.5f, 0, 0});
  const auto r = ask(2);
  CHECK((r.state == clearance::state::collision && r.point == 0 && r.distance == 0 && r.lower == 0 && r.isolated == 0));
  points = {{0.5f, 0, 0}};
  CHECK((ask(1).state == clearance::state::collision && ask(1).point == 0));
}

}  // namespace min_distance_supported_test
