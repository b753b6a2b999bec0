// SPDX-License-Identifier: BSD-3-Clause
// How fast gaps close, and how wide they must be.
#include "support/laws.hpp"

#include <clearance/separation.hpp>

namespace separation_test {

using clearance::approach_speed, clearance::protective_separation, clearance::separation_terms;
using Eigen::Vector3d;

namespace {

clearance::part_witness witness() {
  clearance::part_witness w;
  w.part = 0, w.distance = 0.5, w.at = {2.5, 0, 0}, w.nearest = {2, 0, 0}, w.normal = {1, 0, 0};
  return w;
}

}  // namespace

TEST_CASE("A gap closes as the part comes, as it turns towards the point, and as the point comes") {
  const Vector3d zero = Vector3d::Zero(), x = Vector3d::UnitX(), z = Vector3d::UnitZ();
  const auto w = witness();
  CHECK(*approach_speed(w, 0.3 * x, zero, zero) == Approx(0.3));
  CHECK(*approach_speed(w, -0.3 * x, zero, zero) == Approx(-0.3));
  CHECK(*approach_speed(w, 5 * z, zero, zero) == Approx(0).margin(1e-12));
  CHECK(*approach_speed(w, zero, 2 * z, Vector3d(2, 3, 0)) == Approx(6));  // 3 m beside the axis, on its -y side
  CHECK(*approach_speed(w, zero, zero, zero, -1.6 * x) == Approx(1.6));
  CHECK(*approach_speed(w, 0.5 * x, zero, zero, 0.5 * x) == Approx(0).margin(1e-12));
}

TEST_CASE("A gap's speed is what its distance loses in a time") {
  testing::verdict v;
  testing::dice d(15);
  for (int trial = 0; trial < 200; ++trial) {
    const auto any = [&] { return Vector3d(d.uniform(-1, 1), d.uniform(-1, 1), d.uniform(-1, 1)); };
    const Vector3d center = any(), point = center + 1.5 * any().normalized(), velocity = any(), turning = any(),
                   about = any(), point_velocity = any();
    const Vector3d n = (point - center).normalized(), near = center + 0.25 * n;
    clearance::part_witness w;
    w.part = 3, w.distance = 1.25, w.nearest = {near.x(), near.y(), near.z()},
    w.normal = {float(n.x()), float(n.y()), float(n.z())};
    const double h = 1e-4;
    const Vector3d moved = center + h * (velocity + turning.cross(center - about));  // a sphere is where its centre is
    const double rate = ((point - center).norm() - (point + h * point_velocity - moved).norm()) / h;
    v.require(std::abs(*approach_speed(w, velocity, turning, about, point_velocity) - rate) < 2e-3, "trial", trial, ":",
              rate);
  }
}

TEST_CASE("A gap without a direction has no speed, and speeds are numbers") {
  const Vector3d zero = Vector3d::Zero();
  auto w = witness();
  CHECK(!approach_speed(clearance::min_distance_result{}, zero, zero, zero));
  w.distance = 0;
  CHECK(!approach_speed(w, zero, zero, zero));
  const Vector3d bad(0, std::nan(""), 0);
  w = witness();
  CHECK_THROWS_AS(approach_speed(w, bad, zero, zero), std::invalid_argument);
  CHECK_THROWS_AS(approach_speed(w, zero, bad, zero), std::invalid_argument);
  CHECK_THROWS_AS(approach_speed(w, zero, zero, bad), std::invalid_argument);
  CHECK_THROWS_AS(approach_speed(w, zero, zero, zero, bad / 0.0), std::invalid_argument);
}

TEST_CASE("The protective separation is the sum of its terms, and every term is said") {
  const separation_terms s{.human_speed = 1.6,
                           .robot_speed = 0.5,
                           .reaction_time = 0.1,
                           .stopping_time = 0.4,
                           .stopping_distance = 0.09,
                           .intrusion = 0.2,
                           .human_uncertainty = 0.05,
                           .robot_uncertainty = 0.003};
  CHECK(protective_separation(s) == Approx(1.6 * 0.5 + 0.5 * 0.1 + 0.09 + 0.2 + 0.05 + 0.003));
  CHECK(protective_separation({0, 0, 0, 0, 0, 0, 0, 0}) == 0);
  CHECK_THROWS_AS(protective_separation({}), std::invalid_argument);
  double separation_terms::* const terms[] = {
      &separation_terms::human_speed,       &separation_terms::robot_speed,       &separation_terms::reaction_time,
      &separation_terms::stopping_time,     &separation_terms::stopping_distance, &separation_terms::intrusion,
      &separation_terms::human_uncertainty, &separation_terms::robot_uncertainty};
  for (const auto term : terms) {
    auto more = s;
    more.*term += 0.5;
    CHECK(protective_separation(more) > protective_separation(s));
    for (const double bad : {-1e-9, std::nan(""), double(clearance::infinity)}) {
      auto wrong = s;
      wrong.*term = bad;
      CHECK_THROWS_AS(protective_separation(wrong), std::invalid_argument);
    }
  }
}

}  // namespace separation_test
