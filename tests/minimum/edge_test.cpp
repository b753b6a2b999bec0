// SPDX-License-Identifier: BSD-3-Clause
// Extreme numbers on the host: the answer of brute force in every bit, and the truth within the bracket.
#include "minimum/edge_cases.hpp"

#include <clearance/volume/sphere.hpp>

namespace edge_test {

using namespace testing;
using clearance::host, clearance::min_distance, clearance::point_span;

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

/// Against brute force, whose distances the truth is near.
struct by_definition {
  const scene<inner_sphere>& s;
  verdict& v;
  std::string what;

  void operator()(const clearance::min_distance_result& r, const clearance::min_distance_per_part_result& by_parts,
                  const std::vector<Eigen::Isometry3d>& poses, const std::string& when) const {
    const auto expected = brute_force(brute_parts(s), poses, {brute_cloud(point_span(s.points), s.cloud_pose)});
    require_equal(r, expected, v, what + ", " + when);
    require_equal(by_parts.all, expected, v, what + ", per part, " + when);
    require_equal(by_parts.parts, expected, v, what + ", " + when);
    if (expected.part == none || (poses.size() < 4 && when != "cold")) return;  // the large parts' truth takes long
    const wide truth = truth_of(s, poses), to_solid = std::max(truth, wide(0));
    v.require(r.lower <= to_solid && to_solid <= r.upper, what, ", ", when, ": bracket", r.lower, " to", r.upper,
              " misses", truth);
    v.require(std::isfinite(r.distance), what, ", ", when, ": not finite");
  }
};

}  // namespace

TEST_CASE("Extreme numbers of parts, spheres, points and metres are exact on the host") {
  verdict v;
  const auto check = [&](const auto& s, const auto& model, const std::string& what) {
    check_edge(host{2}, model, s.poses, s.points, s.cloud_pose, v, what, by_definition{s, v, what});
    check_edge(host{1}, model, s.poses, s.points, s.cloud_pose, v, what + ", one thread", nobody);
  };
  for (const auto& s : edge_scenes()) {
    const auto model = edge_model(s);
    check(s, model, s.name);
    if (s.name != deep_scene) continue;
    const auto binary = edge_model(s, {.width = 2});
    for (const auto& deep : {model.parts()[0].view().tree, binary.parts()[0].view().tree})
      CHECK(clearance::stack_need(deep) >= 60);
    check(s, binary, s.name + ", width 2");
  }
}

TEST_CASE("Where every point is inside a solid the distance is 0, at the first point, and it is a collision") {
  verdict v;
  check_all_inside(host{2}, 20000, v, [&](const auto& model, const std::vector<vec3>& points) {
    using interior = decltype(model.parts()[0].view().interior);
    std::vector<brute_part<triangle, interior>> parts;
    for (const auto& part : model.parts()) {  // in the user's order, as brute force counts
      parts.push_back({part.tree.primitives, part.facts, part.view().interior});
      for (std::size_t i = 0; i < part.tree.ids.size(); ++i)
        parts.back().primitives[part.tree.ids[i]] = part.tree.primitives[i];
    }
    return [&, parts](const auto& r, const auto& by_parts, const auto& poses, const std::string& when) {
      const auto expected = brute_force(parts, poses, {brute_cloud(point_span(points))});
      require_equal(r, expected, v, when);
      require_equal(by_parts.all, expected, v, when);
      require_equal(by_parts.parts, expected, v, when);
    };
  });
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
