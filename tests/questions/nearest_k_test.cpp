// SPDX-License-Identifier: BSD-3-Clause
// The k nearest points of each part are those of a plain loop over all points and primitives, sorted and cut.
#include "support/brute_nearest.hpp"
#include "support/question_laws.hpp"

#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace nearest_k_test {

using namespace testing;
using clearance::host, clearance::nearest_k, clearance::point_span;

TEST_CASE("The k nearest points of inner spheres are the first of all, in order") {
  nearest_k_cases cases;
  hold_in_all_scenes<clearance::sphere, inner_sphere>(cases, host{}, host{1});
}
TEST_CASE("The k nearest points of triangles are the first of all, in order") {
  nearest_k_cases cases;
  hold_in_all_scenes<clearance::aabb, triangle>(cases, host{}, host{1});
}

TEST_CASE("The nearest of very many that are about equally near, or exactly") {
  verdict v;
  dice d(41);
  scene<inner_sphere> s;
  s.parts = {{{{0, 0, 0}, 0.5f}}, {{{20, 0, 0}, 0.1f}, {{0, 0, 0}, 0.25f}}},
  s.poses = {shifted(0, 0, 0), shifted(0.125, 0, 0)};
  for (int i = 0; i < 200000; ++i)
    s.points.push_back(clearance::scaled(2 + 1e-4f * d.number(0, 1), d.direction()));  // a shell: more than one pass
  for (int i = 0; i < 100000; ++i) s.points.push_back({i % 2 ? 2.0f : -2.0f, 0, 0});
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const clouds cloud{{point_span(s.points)}};
  for (const std::size_t k : {1, 10, 3000, 150000})
    require_same(ask(host{}, model, s.poses, cloud, nearest_k{k}), brute_nearest(s, cloud, k, clearance::infinity), v,
                 std::to_string(k));
}

TEST_CASE("How many and how far are numbers, and no point is no pair") {
  const clearance::model robot{std::vector{
      clearance::make_part(clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{0, 0, 0}, 1}}))}};
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const std::vector<vec3> points{{3, 0, 0}, {2, 0, 0}, {clearance::not_a_number, 0, 0}};
  const auto r = ask(host{}, robot, poses, points, nearest_k{3});
  CHECK((r.of(0)[0].point == 1 && r.of(0)[1].point == 0 && r.of(0)[2].point == clearance::none &&
         r.of(0)[2].distance == clearance::infinity));
  CHECK((r.counts.seen == 3 && r.counts.valid == 2 && r.certain.lower(r.of(0)[0].distance) > 0.99f));
  CHECK(ask(host{}, robot, poses, points, nearest_k{2, 1.5f}).of(0)[1].point == clearance::none);
  CHECK(ask(host{}, robot, poses, std::vector<vec3>{}, nearest_k{1}).of(0)[0].cloud == clearance::none);
  CHECK_THROWS_AS(ask(host{}, robot, poses, points, nearest_k{0}), std::invalid_argument);
  const std::size_t most = clearance::pairwise::most_listed;
  CHECK(ask(host{}, robot, poses, points, nearest_k{most}).of(0)[0].point == 1);
  CHECK_THROWS_AS(ask(host{}, robot, poses, points, nearest_k{most + 1}), std::invalid_argument);
  CHECK_THROWS_AS(ask(host{}, robot, poses, points, nearest_k{1, clearance::not_a_number}), std::invalid_argument);
}

TEST_CASE("Prepared, the nearest are in every frame what one call says, and after one that is refused") {
  nearest_k_cases cases;
  hold_in_every_frame(cases, host{}, 5, 114);
}

TEST_CASE(
    "Prepared, the nearest are what one call says, a little farther and far behind what is known, and near again") {
  verdict v;
  moving_frames f(5, 114);
  const auto model = f.model();
  clearance::query query(host{}, model, nearest_k{});
  for (const double away : {0.0, 0.0, 0.01, 0.5, 0.0, 3.0}) {
    for (auto& pose : f.s.poses) pose.translation().x() += away;
    f.see(3000);
    for (const std::size_t k : {40, 7, 100}) {
      const std::string what = std::to_string(k) + " after " + std::to_string(away) + " m";
      for (const real d_max : {clearance::infinity, 0.5f})
        require_same(query(f.s.poses, f.here(), {k, d_max}),
                     ask(host{}, model, f.s.poses, f.here(), nearest_k{k, d_max}), v, what);
    }
  }
}

TEST_CASE("Of a robot of many parts before a frame of many points the nearest are the first of all, from cold") {
  verdict v;
  dice d(42);
  scene<inner_sphere> s;
  for (int k = 0; k < 20; ++k) {
    s.parts.push_back({{{0, 0, 0}, 0.05f}, {{0.1f, 0, 0}, 0.03f}});
    s.poses.push_back(d.pose(0.8));
  }
  for (int i = 0; i < 30000; ++i)  // a wall, row by row, and floor
    s.points.push_back(i % 3 != 0 ? vec3{1.5f, float(i % 200) / 100 - 1, float(i / 200) / 75 - 1}
                                  : vec3{float(i % 211) / 100 - 1, float(i / 211) / 75 - 1, -1});
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const clouds two{{point_span(s.points)}, {point_span(s.points), d.pose(0.3)}};
  for (const std::size_t k : {1, 50, 2000})
    for (const real d_max : {clearance::infinity, 0.4f})
      require_same(ask(host{}, model, s.poses, two, nearest_k{k, d_max}), brute_nearest(s, two, k, d_max), v,
                   std::to_string(k) + " within " + std::to_string(d_max));
}

}  // namespace nearest_k_test
