// SPDX-License-Identifier: BSD-3-Clause
// Extreme numbers on the host: the answer of brute force in every bit, and the truth within the bracket.
#include "minimum/edge_scenes.hpp"
#include "solid/shapes.hpp"
#include "support/product.hpp"

#include <clearance/make_model.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace edge_test {

using namespace testing;
using clearance::host, clearance::min_distance, clearance::min_distance_per_part, clearance::placed,
    clearance::point_span;

namespace {

/// The distance in long double, all the way from the input.
wide truth_of(const scene<inner_sphere>& s, const std::vector<Eigen::Isometry3d>& poses) {
  wide least = infinity;
  for (const vec3 p : s.points) {
    if (!clearance::is_finite(p)) continue;
    const auto world = oracle::moved(s.cloud_pose.matrix(), wider(p));
    for (std::size_t k = 0; k < s.parts.size(); ++k) {
      const auto q = oracle::moved_back(poses[k].matrix(), world);
      for (const inner_sphere& b : s.parts[k]) least = std::min(least, oracle::to_sphere(q, wider(b.center), b.radius));
    }
  }
  return least;
}

/// Plain, cold, warm, moved and moved back.
template <class Model>
void ask(const Model& model, const scene<inner_sphere>& s, verdict& v, const std::string& what) {
  const auto parts = brute_parts(s);
  auto poses = s.poses;
  const placed cloud{point_span(s.points), s.cloud_pose};
  clearance::query query(host{2}, model, min_distance{});
  clearance::query alone(host{1}, model, min_distance_per_part{});
  brute_answer expected;
  const auto same = [&](const std::string& when) {
    require_equal(ask(host{}, model, poses, cloud, min_distance{}), expected, v, what + ", plain, " + when);
    require_equal(query(poses, cloud), expected, v, what + ", " + when);
    const auto& [r, minima] = alone(poses, cloud);
    require_equal(r, expected, v, what + ", per part, " + when);
    require_equal(minima, expected, v, what + ", " + when);
  };
  const auto moved = [&](const std::string& when) {
    expected = brute_force(parts, poses, {brute_cloud(cloud.source, cloud.pose)});
    same(when);
    if (expected.part == none || (poses.size() < 4 && when != "cold")) return;  // the large parts' truth takes long
    const wide truth = truth_of(s, poses), to_solid = std::max(truth, wide(0));
    const auto r = query(poses, cloud);
    v.require(r.lower <= to_solid && to_solid <= r.upper, what, ", ", when, ": bracket", r.lower, " to", r.upper,
              " misses", truth);
    v.require(std::isfinite(r.distance), what, ", ", when, ": not finite");
  };
  moved("cold");
  same("warm");
  poses[0].translation().x() += 0.01, poses.back().translation().z() -= 5;
  moved("moved");
  poses = s.poses;
  query.forget();
  moved("moved back");
}

}  // namespace

TEST_CASE("Extreme numbers of parts, spheres, points and metres are exact on the host") {
  verdict v;
  for (const auto& s : edge_scenes()) {
    const auto model = edge_model(s);
    ask(model, s, v, s.name);
    if (s.name != deep_scene) continue;
    const auto binary = edge_model(s, {.width = 2});
    for (const auto& deep : {model.parts()[0].view().tree, binary.parts()[0].view().tree})
      CHECK(clearance::stack_need(deep) >= 60);
    ask(binary, s, v, s.name + ", width 2");
  }
}

TEST_CASE("Where every point is inside a solid the distance is 0, at the first point, and it is a collision") {
  dice d(79);
  verdict v;
  std::vector<decltype(clearance::make_part<clearance::obb>(clearance::close_mesh(shapes::cube(1))))> parts;
  std::vector<brute_part<triangle, decltype(parts[0].view().interior)>> brute;
  for (const double half : {2.0, 1.0, 3.0})
    parts.push_back(clearance::make_part<clearance::obb>(clearance::close_mesh(shapes::cube(half))));
  for (const auto& part : parts) brute.push_back({part.tree.primitives, part.facts, part.view().interior});
  for (std::size_t k = 0; k < brute.size(); ++k)  // in the user's order, as brute force counts
    for (std::size_t i = 0; i < brute[k].primitives.size(); ++i)
      brute[k].primitives[parts[k].tree.ids[i]] = parts[k].tree.primitives[i];
  const clearance::model model(std::move(parts));
  for (const double off : {0.0, 1000.0}) {  // the second box
    const std::vector<Eigen::Isometry3d> poses = {d.pose(0.1), shifted(off, 0, 0) * d.pose(0.1), d.pose(0.1)};
    auto points = d.points(20000, 0.5);
    points[0].z = clearance::not_a_number;
    clearance::query query(host{2}, model, min_distance{});
    clearance::query by_parts(host{2}, model, min_distance_per_part{});
    const auto expected = brute_force(brute, poses, {brute_cloud(point_span(points))});
    for (const char* when : {"cold", "warm"}) {
      const auto r = query(poses, points);
      require_equal(r, expected, v, when);
      CHECK((r.distance == 0 && r.point == 1 && r.part == 0 && r.state == clearance::state::collision && r.upper == 0 &&
             r.lower == 0));
      const auto& [robot, minima] = by_parts(poses, points);
      require_equal(robot, expected, v, when);
      require_equal(minima, expected, v, when);
    }
  }
}

TEST_CASE(
    "Poses so far away that distances in float would overflow are refused; up to there every distance is finite") {
  const auto s = small_robot();
  const auto model = edge_model(s);
  clearance::query query(host{}, model, min_distance{});
  const auto ask = [&](double robot, double cloud) {
    auto poses = s.poses;
    for (auto& pose : poses) pose.translation().setConstant(robot);
    return query(poses, point_span(s.points), shifted(cloud, cloud, cloud));
  };
  const auto r = ask(-1e18, 1e18);
  CHECK(r.state == clearance::state::free);
  CHECK(std::abs(r.distance - std::sqrt(12) * 1e18) < 1e13);
  CHECK((r.lower <= r.distance && r.distance <= r.upper && r.upper < infinity));
  for (const double far : {1.01e18, 1e20, 1e300}) {
    CHECK_THROWS_AS(ask(far, 0), std::invalid_argument);
    CHECK_THROWS_AS(ask(0, -far), std::invalid_argument);
  }
}

TEST_CASE("Ten million points: the one that is near is found wherever it is", "[slow]") {
#if defined(CLEARANCE_SANITIZED)
  constexpr std::size_t n = 1'000'001;
#else
  constexpr std::size_t n = 10'000'001;
#endif
  const auto s = small_robot();
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto expected = brute_force(brute_parts(s), s.poses, {brute_cloud(point_span(s.points))});
  std::vector<vec3> cloud(n);
  for (std::size_t i = 0; i < n; ++i) cloud[i] = endless_points{n}[i].position;
  REQUIRE(expected.best.distance < 2);
  clearance::query query(host{}, model, min_distance{});
  for (const std::size_t at : {std::size_t(0), std::size_t(7), n / 2, n - 2, n - 1}) {
    const endless_points all{n, at};
    const vec3 before = cloud[at];
    cloud[at] = endless_points::near();
    for (const auto& r : {query(s.poses, cloud), query(s.poses, all, Eigen::Isometry3d::Identity()),
                          ask(host{}, model, s.poses, cloud, min_distance{})}) {
      CHECK(same_bits(r.distance, expected.best.distance));
      CHECK((r.point == at && r.part == expected.part && r.primitive == expected.best.primitive));
      CHECK((r.seen == n && r.valid == all.valid()));
    }
    cloud[at] = before;
  }
  const auto r = query(s.poses, cloud);
  CHECK(r.distance >= 2);
  const auto same = ask(host{1}, model, s.poses, endless_points{n}, min_distance{});
  CHECK((same_bits(r.distance, same.distance) && r.point == same.point && r.primitive == same.primitive &&
         r.valid == same.valid));
}

}  // namespace edge_test
