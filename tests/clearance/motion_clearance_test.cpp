// SPDX-License-Identifier: BSD-3-Clause
// The clearance over a motion is never above what dense sampling finds, and near it.
#include "support/brute_pairs.hpp"
#include "support/product.hpp"

#include <clearance/motion_clearance.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

#include <numbers>

namespace motion_clearance_test {

using namespace testing;
using clearance::host, clearance::min_distance, clearance::motion_clearance, clearance::part_facts,
    clearance::point_span, clearance::state, clearance::straight_motion;

namespace {

using poses_type = std::vector<Eigen::Isometry3d>;

/// The least distance at `times` times, by asking for each.
template <class Model, class Motion, class Clouds>
double sampled(const Model& model, const Motion& motion, const Clouds& clouds, int times) {
  clearance::query query(host{}, model, min_distance{});
  double least = clearance::infinity;
  for (int i = 0; i <= times; ++i)
    least = std::min(least, double(query(motion.at(double(i) / times, model.view().facts).poses, clouds).distance));
  return std::max(0.0, least);
}

/// Shifts and turns of any size; parts far from their axes too.
template <class V, class P>
void against_samples() {
  verdict v;
  dice d(77);
  std::size_t free = 0, big = 0;
  for (int trial = 0; trial < 40; ++trial) {
    scene<P> s;
    const double away = trial % 3 == 0 ? 1 : 0;  // of the part's own axis
    for (int k = 0; k < 3; ++k) {
      s.parts.push_back(random_primitives<P>(d, 12, 0.2, 0.1));
      if constexpr (std::is_same_v<P, inner_sphere>)
        for (P& p : s.parts.back()) p.center.x += real(away);
      s.poses.push_back(d.pose(0.7));
    }
    s.points = d.points(trial % 4 == 0 ? 12 : 80, 2);
    poses_type to;
    for (const auto& pose : s.poses) to.push_back(trial % 2 == 0 ? d.pose(0.7) : shifted(0.3, 0.1, -0.2) * pose);
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const straight_motion motion(s.poses, to);
    const point_span cloud(s.points);
    const auto r = motion_clearance(host{}, model, motion, cloud, {.tolerance = 0.004});
    const double least = sampled(model, motion, cloud, 1000);
    v.require(double(r.lower) <= least, "trial", trial, ": lower", r.lower, " but at some time", least);
    v.require(r.settled && double(r.lower) >= least - 0.0041, "trial", trial, ": lower", r.lower, " of", least,
              " after", r.queries);
    v.require(double(r.upper) >= double(r.lower) && double(r.upper) <= least + 0.0082, "trial", trial, ": upper",
              r.upper, " of", least);
    v.require(r.state == (r.lower > 0    ? state::free
                          : r.upper <= 0 ? state::collision
                                         : state::possible),
              "trial", trial, ": the state");
    v.require(r.from <= r.to && r.from >= 0 && r.to <= 1 && r.part < 3 && r.time >= 0 && r.time <= 1, "trial", trial,
              ": where");
    const auto there = ask(host{}, model, motion.at(r.time, model.view().facts).poses, cloud, min_distance{});
    v.require(there.point == r.nearest.point && same_bits(there.distance, r.nearest.distance), "trial", trial,
              ": the witness is that of its time");
    free += r.state == state::free, big += trial % 2 == 0 && r.lower > 0;
    clearance::query query(host{}, model, clearance::min_distance_per_part{});
    const auto by_query = motion_clearance(query, model, motion, cloud, {.tolerance = 0.004});
    const auto plain = motion_clearance(clearance::plain{host{1}, clearance::near_first{}}, model, motion,
                                        clearance::placed{cloud}, {.tolerance = 0.004});
    for (const auto& other : {by_query, plain})
      v.require(same_bits(other.lower, r.lower) && same_bits(other.upper, r.upper) && other.time == r.time &&
                    other.part == r.part && other.queries == r.queries,
                "trial", trial, ": another way of asking");
    real lower = 0;
    for (std::size_t most = 1; most < 60; most += 2) {
      const real better =
          motion_clearance(host{}, model, motion, cloud, {.tolerance = 0.004, .most_queries = most}).lower;
      v.require(better >= lower, "trial", trial, ": more queries make it worse,", better, " after", lower);
      lower = better;
    }
    for (const std::size_t most :
         {std::size_t(1), std::size_t(2), std::size_t(7), r.queries}) {  // what is left open is on the safe side
      const auto few = motion_clearance(host{}, model, motion, cloud, {.tolerance = 0.004, .most_queries = most});
      v.require(few.queries <= most && double(few.lower) <= least && few.upper >= r.upper && few.lower <= r.lower,
                "trial", trial, ": with", most, " queries", few.lower);
      v.require(few.settled == (few.queries == r.queries), "trial", trial, ": settled with", most);
    }
  }
  CHECK(free > 10);
  CHECK(big > 3);
}

/// One ball of radius 0.1, in a part whose origin is `out` from it.
auto one_ball(double out, double gap = 0) {
  return clearance::model{std::vector{clearance::make_part(
      clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{real(out), 0, 0}, 0.1f}}), gap)}};
}

/// Stands still, and claims so only of the middle.
struct unsure_motion {
  clearance::moment at(double t, std::span<const part_facts>) const {
    const double speed = t == 0.5 ? 0.1 : 100;
    return {{Eigen::Isometry3d::Identity()}, {{speed, 0, speed, 0}}};
  }
};

}  // namespace

TEST_CASE("No time of a motion has less than its clearance: spheres") {
  against_samples<clearance::sphere, inner_sphere>();
}
TEST_CASE("No time of a motion has less than its clearance: triangles") {
  against_samples<clearance::aabb, triangle>();
}

TEST_CASE("A moment's bound holds for every point of a part at every time") {
  verdict v;
  dice d(8);
  double tightest = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const poses_type from{d.pose(1)},
        to{trial % 5 == 0 ? shifted(0.5, 0, 0) * from[0] : d.pose(trial % 2 == 0 ? 1 : 0)};
    const straight_motion motion(from, to);
    const std::vector<part_facts> parts{{d.point(1), d.number(0, 0.5), d.number(0, 0.1), d.number(0, 0.1)}};
    const double t = d.uniform(0, 1), other = d.uniform(0, 1);
    const auto now = motion.at(t, parts), then = motion.at(other, parts);
    for (int k = 0; k < 20; ++k) {
      const vec3 n = d.direction();
      const double r = clearance::solid_radius(parts[0]);
      const Eigen::Vector3d p = clearance::center_of(parts[0]) + r * Eigen::Vector3d(n.x, n.y, n.z).normalized();
      const double moved = (now.poses[0] * p - then.poses[0] * p).norm(),
                   most = now.travels[0].within(std::abs(other - t));
      v.require(moved <= most, "a point moves", moved, " of at most", most);
      tightest = std::max(tightest, moved / most);
    }
    for (const auto& [at, pose] : {std::pair(0.0, from[0]), std::pair(1.0, to[0])})
      v.require((motion.at(at, parts).poses[0].matrix() - pose.matrix()).cwiseAbs().maxCoeff() < 1e-13,
                "a motion begins and ends where it is said to");
  }
  CHECK(tightest > 0.95);
}

TEST_CASE("A ball that passes a point halfway is seen to touch it, or to miss it by what it does") {
  const poses_type from{shifted(-50, 0, 0)}, to{shifted(50, 0, 0)};
  const straight_motion motion(from, to);
  const auto pass = [&](real y, double tolerance) {
    return motion_clearance(host{}, one_ball(0), motion, std::vector<vec3>{{7, y, 0}}, {.tolerance = tolerance});
  };
  const auto hit = pass(0, 0.01);
  CHECK(hit.lower == 0);
  CHECK(hit.state == state::collision);
  CHECK((hit.from <= 0.571 && hit.to >= 0.569));
  const auto miss = pass(0.101f, 1e-5);
  CHECK(miss.state == state::free);
  CHECK(miss.lower <= 0.001f);
  CHECK(miss.lower > 0.0009f);
  CHECK(std::abs(miss.time - 0.57) < 1e-3);
  CHECK(miss.queries < 1000);  // of 10,000,000 pieces of 1e-5 m
}

TEST_CASE("A wall of one layer of points is no tunnel") {
  std::vector<vec3> wall;
  for (int i = -60; i <= 60; ++i)
    for (int j = -60; j <= 60; ++j) wall.push_back({0.317f, 0.03f * real(i), 0.03f * real(j)});
  for (const double speed : {1.0, 10.0, 1000.0}) {
    const straight_motion motion(poses_type{shifted(-speed, 0, 0)}, poses_type{shifted(speed, 0, 0)});
    const auto r = motion_clearance(host{}, one_ball(0), motion, wall);
    CHECK(r.lower == 0);
    CHECK(r.state == state::collision);
  }
}

TEST_CASE("A part that swings far from its axis is seen where it swings") {
  // The ball is 3 m from the origin that it turns about, by 170 degrees; the point is on its way.
  const poses_type from{Eigen::Isometry3d::Identity()},
      to{Eigen::Isometry3d(Eigen::AngleAxisd(170 * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()))};
  const straight_motion motion(from, to);
  const double angle = 1.1;
  const auto swing = [&](double distance) {
    const std::vector<vec3> point{{real(distance * std::cos(angle)), real(distance * std::sin(angle)), 0}};
    return motion_clearance(host{}, one_ball(3), motion, point, {.tolerance = 1e-4});
  };
  CHECK(swing(3.05).state == state::collision);
  const auto past = swing(3.15);
  CHECK(past.state == state::free);
  CHECK(past.lower <= 0.05f);
  CHECK(past.lower > 0.0498f);
  CHECK(std::abs(past.time - angle / (170 * std::numbers::pi / 180)) < 0.01);
}

TEST_CASE("Without motion one question decides, whatever the tolerance") {
  dice d(3);
  const poses_type poses{d.pose(1)};
  const straight_motion motion(poses, poses);
  const std::vector<vec3> points{{2, 1, 0}, {0, 3, 1}};
  const auto still = ask(host{}, one_ball(0.2, 0.01), poses, points, min_distance{});
  const auto r = motion_clearance(host{}, one_ball(0.2, 0.01), motion, points, {.tolerance = 0});
  CHECK(r.queries == 1);
  CHECK(r.settled);
  CHECK(r.lower <= still.lower);
  CHECK(r.lower > still.lower - 1e-6f);
  CHECK(same_bits(r.upper, still.upper));
}

TEST_CASE("Margins, deciding only, no certificate, and no data") {
  const straight_motion motion(poses_type{shifted(-1, 0, 0)}, poses_type{shifted(1, 0, 0)});
  const auto ask = [&](const auto& model, std::vector<vec3> points, clearance::motion_clearance_options options) {
    return motion_clearance(host{}, model, motion, points, options);
  };
  const std::vector<vec3> beside{{0.3f, 0.5f, 0}};  // 0.4 m from the way
  CHECK(ask(one_ball(0), beside, {.margin = 0.35}).state == state::free);
  CHECK(ask(one_ball(0), beside, {.margin = 0.41}).state == state::collision);
  CHECK(ask(one_ball(0), beside, {.tolerance = 0.02, .margin = 0.395}).state == state::possible);
  const auto only = ask(one_ball(0), beside, {.tolerance = clearance::infinity, .margin = 0.2});
  const auto fine = ask(one_ball(0), beside, {.tolerance = 1e-4, .margin = 0.2});
  CHECK(only.state == state::free);
  CHECK(only.queries < fine.queries);
  CHECK((only.settled && only.lower > 0.2f));
  CHECK(ask(one_ball(0), beside, {.tolerance = clearance::infinity, .margin = 0.5}).queries < 10);
  CHECK(ask(one_ball(0), beside, {.tolerance = clearance::infinity, .margin = 0.4, .most_queries = 100}).queries <=
        100);

  const auto gap = ask(one_ball(0, 0.1), beside, {.tolerance = 1e-3});
  CHECK((gap.lower <= 0.3f && gap.lower > 0.2989f && gap.upper >= 0.4f));
  const auto open = ask(one_ball(0, clearance::infinity), beside, {});
  CHECK((open.lower == 0 && open.state == state::possible && open.queries == 1));

  for (const auto& points : {std::vector<vec3>{}, std::vector<vec3>{{clearance::not_a_number, 0, 0}}}) {
    const auto none = ask(one_ball(0), points, {});
    CHECK((none.state == state::no_data && none.lower == 0 && none.upper == clearance::infinity && none.queries == 1 &&
           !none.settled));
    CHECK(none.nearest.seen == points.size());
  }
}

TEST_CASE("A motion of one's own is as good as its speeds") {
  // Half a circle of radius 1 around the point; turning does nothing to a ball.
  const auto circle = [](double t) {
    return poses_type{shifted(std::cos(std::numbers::pi * t), std::sin(std::numbers::pi * t), 0)};
  };
  const std::vector<vec3> middle{{0, 0, 0}};
  const auto r = motion_clearance(host{}, one_ball(0), clearance::timed_motion{circle, {std::numbers::pi}}, middle,
                                  {.tolerance = 0.005});
  CHECK((r.lower <= 0.9f && r.lower > 0.8949f && r.state == state::free));
  const auto unknown =
      motion_clearance(host{}, one_ball(0), clearance::timed_motion{circle, {double(clearance::infinity)}}, middle,
                       {.most_queries = 50});
  CHECK((unknown.lower == 0 && unknown.state == state::possible && unknown.queries == 1));
}

TEST_CASE("What one question made certain stays so") {
  for (const std::size_t most : {1, 3, 9}) {
    const auto r = motion_clearance(host{}, one_ball(0), unsure_motion{}, std::vector<vec3>{{1, 0, 0}},
                                    {.tolerance = 1e-3, .most_queries = most});
    CHECK((r.lower > 0.8499f && r.lower <= 0.9f && r.queries == most));
  }
}

TEST_CASE("What is no motion, and what cannot be asked, is refused") {
  const poses_type one{Eigen::Isometry3d::Identity()};
  const std::vector<vec3> points{{1, 1, 1}};
  auto wrong = one;
  wrong[0](0, 3) = clearance::not_a_number;
  CHECK_THROWS_AS(straight_motion(one, wrong), std::invalid_argument);
  wrong[0] = shifted(0, 0, 0), wrong[0].linear() *= 2;
  CHECK_THROWS_AS(straight_motion(wrong, one), std::invalid_argument);
  CHECK_THROWS_AS(straight_motion(one, poses_type{}), std::invalid_argument);
  const straight_motion motion(one, one);
  const auto refused = [&](const auto& m, clearance::motion_clearance_options options) {
    CHECK_THROWS_AS(motion_clearance(host{}, one_ball(0), m, points, options), std::invalid_argument);
  };
  for (const double bad : {-1e-9, double(clearance::not_a_number)}) {
    refused(motion, {.tolerance = bad});
    refused(motion, {.margin = bad});
    refused(clearance::timed_motion{[&](double) { return one; }, {bad}}, {});
  }
  refused(motion, {.margin = clearance::infinity});
  refused(motion, {.most_queries = 0});
  const poses_type two(2, one[0]);
  refused(straight_motion(two, two), {});
  refused(clearance::timed_motion{[&](double) { return two; }, {1.0}}, {});
  refused(clearance::timed_motion{[&](double) { return one; }, {1.0, 2.0}}, {});
  wrong[0](0, 0) = clearance::not_a_number;
  refused(clearance::timed_motion{[&](double) { return wrong; }, {1.0}}, {});
}

}  // namespace motion_clearance_test
