// SPDX-License-Identifier: BSD-3-Clause
// In many configurations a robot is as far from itself as in each of them, and samples say which parts can meet.
#include "clearance/itself.hpp"
#include "support/catch.hpp"
#include "support/laws.hpp"

#include <clearance/self_distances.hpp>

namespace self_distances_test {

using namespace testing;
using clearance::host, clearance::part_pairs, clearance::self_distance, clearance::self_distances,
    clearance::self_queries, clearance::state;

namespace {

double apart(clearance::position p, clearance::position q) { return std::hypot(p.x - q.x, p.y - q.y, p.z - q.z); }

/// `count` configurations, the robot's base moved by `base`.
std::vector<Eigen::Isometry3d> configurations(const chain_of_spheres& robot, dice& d, std::size_t count,
                                              const Eigen::Isometry3d& base) {
  std::vector<Eigen::Isometry3d> all;
  for (std::size_t c = 0; c < count; ++c)
    for (const auto& pose : robot.poses(d)) all.push_back(base * pose);
  return all;
}

}  // namespace

TEST_CASE("In many configurations a robot is as far from itself as in each of them") {
  verdict v;
  dice d(71);
  const chain_of_spheres robot(d, 0.01, 0.6);
  const auto model = robot.model();
  part_pairs pairs(robot.links.size());
  pairs.remove_neighbours(robot.parents());
  self_queries ask(host{}, model, pairs);
  for (const auto& base : {shifted(0, 0, 0), shifted(3e6, -1e6, 50)}) {
    const auto poses = configurations(robot, d, 40, base);
    const auto all = ask(poses);
    v.require(all.size() == 40, "one answer for each");
    for (std::size_t c = 0; c < all.size(); ++c) {
      const std::vector its(poses.begin() + std::ptrdiff_t(5 * c), poses.begin() + std::ptrdiff_t(5 * c + 5));
      const auto one = self_distance(host{}, model, its, pairs);
      v.require(all[c].a == one.a && all[c].b == one.b && std::abs(all[c].distance - one.distance) < 1e-5,
                "configuration", c, " at", all[c].distance, " and not", one.distance);
      v.require(std::abs(all[c].lower - one.lower) < 1e-5 && std::abs(all[c].upper - one.upper) < 1e-5, "bracket");
      v.require(apart(all[c].at_a, one.at_a) < 1e-5 && apart(all[c].at_b, one.at_b) < 1e-5, "places");
      const wide is = between_links(robot.links[one.a], its[one.a], robot.links[one.b], its[one.b]);
      v.require(all[c].lower <= std::max(is, wide(0)) && std::max(is, wide(0)) <= all[c].upper, "the bracket holds");
    }
  }
  CHECK_THROWS_WITH(ask(std::vector<Eigen::Isometry3d>(7, shifted(0, 0, 0))),
                    Catch::Matchers::Contains("7 poses are no whole configurations of 5 parts"));
  CHECK(ask(std::vector<Eigen::Isometry3d>{}).empty());
}

TEST_CASE("Pairs that touch in all samples, and those that never come near, are told and removed") {
  dice d(72);
  const chain_of_spheres robot(d, 0.001, 1);
  const auto model = robot.model();
  const vec3 by = robot.links[1][0].center - robot.links[2][0].center;
  std::vector<Eigen::Isometry3d> poses;  // part 2 stays in part 1, part 4 passes the others but part 3, which is far
  for (const double x : {0.1, 1.5, 4.0})
    for (const auto& pose : {shifted(0, 0, 0), shifted(2, 0, 0), shifted(2, 0, 0) * shifted(by.x, by.y, by.z),
                             shifted(0, 5, 0), shifted(x, 0, 0)})
      poses.push_back(pose);
  const auto sampled = sample_pairs(host{}, model, poses, part_pairs(5), 1.0);
  using list = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  CHECK(sampled.always == list{{1, 2}});
  CHECK(sampled.never == list{{0, 1}, {0, 2}, {0, 3}, {1, 3}, {2, 3}, {3, 4}});
  CHECK((sampled.meeting.size() == 3 && sampled.meeting.has(0, 4) && sampled.meeting.has(1, 4)));
  CHECK(sampled.meeting.has(2, 4));
  CHECK_THROWS_WITH(sample_pairs(host{}, model, poses, part_pairs(5), -1.0),
                    Catch::Matchers::Contains("how near parts must come is -1"));
  CHECK_THROWS_WITH(sample_pairs(host{}, model, {}, part_pairs(5), 1.0),
                    Catch::Matchers::Contains("0 poses are no whole configurations"));
}

}  // namespace self_distances_test
