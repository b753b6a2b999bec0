// SPDX-License-Identifier: BSD-3-Clause
// From each part's distance its own gap and tolerance are taken, by one rule in every question.
#include "questions/tolerances.hpp"

#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace tolerances_test {

using namespace testing;
using clearance::host, clearance::pair_distance;

TEST_CASE("A robot is at least as far as the least of its parts' distances, each less its own gap and tolerance") {
  rule_of_slop rule;
  dice d(77);
  for (int n = 0; n < 60; ++n) {
    const bool any = n % 6 != 5;
    const std::string what = "robot " + std::to_string(n);
    rule.least(host{}, sloppy_spheres<clearance::sphere>(d, any), d, any, what);
    if (n % 3 == 0) rule.least(host{2}, sloppy_solids(d, any), d, any, what + ", solids");
  }
  CHECK(rule.other > 5);
}

TEST_CASE("Any traversal and any tree take each part's own gap and tolerance") {
  verdict v;
  dice d(78);
  for (int n = 0; n < 60; ++n) {
    const auto model = sloppy_spheres<clearance::obb>(d, true);
    const auto poses = some_poses(d, model.view().size());
    const auto points = d.points(9000, 2);
    const auto expected = ask(host{}, model, poses, points, clearance::min_distance_per_part{}).all;
    const auto r =
        ask(clearance::plain{host{}, clearance::near_first{}}, model, poses, points, clearance::min_distance{});
    v.require(same_result(r, expected), "robot", n, ": at least", r.lower, ", and not", expected.lower);
  }
}

TEST_CASE("Lists of pairs are certain by each pair's own part, as the same pair is elsewhere") {
  verdict v;
  dice d(79);
  std::size_t other = 0;
  for (int n = 0; n < 60; ++n) {
    const std::string what = "robot " + std::to_string(n);
    const auto model = sloppy_spheres<clearance::sphere>(d, true);
    const std::size_t parts = model.view().size();
    const auto poses = some_poses(d, parts);
    const auto points = d.points(400, 1.5);
    const auto each = ask(host{}, model, poses, points, clearance::min_distances_per_part{});
    const auto near = ask(host{}, model, poses, points, clearance::nearest_k{.k = 5});
    const auto within = ask(host{}, model, poses, points, clearance::within{{0.5}});
    const auto rows = ask(host{}, model, poses, points, clearance::distances_per_part{});
    const auto own = [&](const auto& certain, real distance, std::size_t k, real lower) {
      const double expected = std::max(double(distance) - clearance::frames::slop(model.view().facts[k]), 0.0);
      v.require(double(lower) <= expected && double(lower) >= expected - 1e-5, what, ": part", k, " at least", lower,
                ", and not", expected);
      other += certain.lower(distance) < lower;
    };
    for (std::size_t k = 0; k < parts; ++k) {
      for (const pair_distance& pair : near.of(k)) own(near.certain, pair.distance, k, near.certain.lower(pair));
      for (std::size_t i = within.offsets[k]; i < within.offsets[k + 1]; ++i)
        own(within.certain, within.pairs[i].distance, k, within.certain.lower(within.pairs[i]));
      for (const real distance : rows.of(k)) own(rows.certain, distance, k, rows.certain.lower(distance, k));
      const real alone = each.of(0)[k].lower, listed = near.certain.lower(near.of(k)[0]);
      v.require(std::abs(alone - listed) <= 3e-6f, what, ": part", k, " at least", alone, ", listed", listed);
    }
    auto both = near;
    clearance::nearest_k::merge(both, near);
    v.require(both.certain.slops == near.certain.slops, what, ": merged");
  }
  CHECK(other > 1000);
}

TEST_CASE("The frames of a prepared question share what each part may be nearer, until one of them is written") {
  dice d(81);
  const auto model = sloppy_spheres<clearance::sphere>(d, true);
  const auto poses = some_poses(d, model.view().size());
  const auto points = d.points(400, 1.5);
  clearance::query ask(host{}, model, clearance::nearest_k{.k = 2});
  const auto first = ask(poses, clearance::point_span(points)).certain.slops,
             next = ask(poses, clearance::point_span(points)).certain.slops;
  CHECK(first.begin() == next.begin());
  auto wider = next;
  wider.data()[0] += 1;
  auto both = next;
  both.widen(wider);
  CHECK(both == wider);
  CHECK(next == first);
  CHECK(next[0] == wider[0] - 1);
}

TEST_CASE("What points confirm is certain by each part's own gap and tolerance, however many are alone before them") {
  verdict v;
  dice d(80);
  std::size_t other = 0, decided = 0;
  for (int n = 0; n < 200; ++n) {
    const std::string what = "robot " + std::to_string(n);
    const auto model = sloppy_spheres<clearance::sphere>(d, n % 8 != 0);
    const std::size_t parts = model.view().size();
    const auto poses = some_poses(d, parts);
    std::vector<vec3> points = d.points(20 + d.below(400), 1.2);
    for (std::size_t i = points.size(); i-- > 0;)
      if (d.below(3) == 0) points.push_back(points[i] + d.point(0.01));
    const clearance::min_distance_supported q{.min_points = 1 + d.below(3), .radius = d.uniform(0.005, 0.1)};
    const auto r = ask(host{}, model, poses, points, q);
    const auto rows = ask(host{}, model, poses, points, clearance::distances_per_part{});
    double lower = infinity;
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::size_t around = 0;
      for (const vec3& p : points)
        around += (Eigen::Vector3d(p.x - points[i].x, p.y - points[i].y, p.z - points[i].z)).norm() <= q.radius;
      if (around < q.min_points) continue;
      for (std::size_t k = 0; k < parts; ++k)
        lower = std::min(lower, double(rows.of(k)[i]) - clearance::frames::slop(model.view().facts[k]));
    }
    if (!(r.distance < infinity)) continue;
    const double expected = std::max(lower, 0.0);
    v.require(double(r.lower) <= expected && double(r.lower) >= expected - 1e-5, what, ": at least", r.lower,
              ", and not", expected);
    if (q.min_points == 1)
      v.require(same_bits(r.lower, ask(host{}, model, poses, points, clearance::min_distance{}).lower), what,
                ": one point confirms itself, and min_distance says something else");
    decided += r.lower > 0;
    other += r.lower > 0 &&
             double(r.lower) < double(r.distance) - clearance::frames::slop(model.view().facts[r.part]) - 1e-4;
    const auto few =
        ask(host{}, model, poses, points, clearance::min_distance_supported{q.min_points, q.radius, d.below(30) + 1});
    v.require(!(few.distance < infinity) || double(few.lower) <= expected, what, ": of few, at least", few.lower);
  }
  INFO(decided << " decided, " << other << " by another part");
  CHECK(other > 10);
}

}  // namespace tolerances_test
