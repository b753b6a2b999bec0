// SPDX-License-Identifier: BSD-3-Clause
// How far a robot is from itself and from another robot is what a loop over all pairs of spheres says.
#include "clearance/itself.hpp"
#include "support/catch.hpp"
#include "support/laws.hpp"

namespace self_distance_test {

using namespace testing;
using clearance::host, clearance::min_distance, clearance::none, clearance::part_pairs, clearance::self_distance,
    clearance::self_query, clearance::state;

TEST_CASE("A robot is as far from itself as the loop over all spheres of all pairs that can meet says") {
  verdict v;
  dice d(61);
  std::size_t free = 0, deep = 0;
  for (int round = 0; round < 12; ++round) {
    const chain_of_spheres robot(d, round % 2 == 0 ? 0.0 : 0.02, round < 6 ? 1.0 : 0.4);
    part_pairs pairs(robot.links.size());
    pairs.remove_neighbours(robot.parents()).remove(0, 3);
    const auto model = robot.model();
    self_query ask(host{}, model, pairs);
    for (int frame = 0; frame < 3; ++frame) {
      const auto poses = robot.poses(d);
      const auto r = ask(poses), again = self_distance(host{2}, model, poses, pairs);
      v.require(same_self(r, again), "asked once, or frame after frame");
      check_itself(robot, poses, pairs, r, v);
      free += r.state == state::free;
      deep += r.state == state::collision;
    }
  }
  CHECK((free > 2 && deep > 2));
}

TEST_CASE("Pairs of another robot, another number of poses, and no pair at all") {
  dice d(62);
  const chain_of_spheres robot(d, 0, 1);
  const auto model = robot.model();
  using Catch::Matchers::Contains;
  CHECK_THROWS_WITH(self_query(host{}, model, part_pairs(2)), Contains("parts, but pairs of 2"));
  self_query ask(host{}, model, part_pairs(robot.links.size()));
  CHECK_THROWS_WITH(ask(std::vector<Eigen::Isometry3d>(2, shifted(0, 0, 0))), Contains("parts, but 2 poses"));
  part_pairs nothing(robot.links.size());
  for (std::size_t a = 0; a < nothing.parts(); ++a)
    for (std::size_t b = 0; b < a; ++b) nothing.remove(a, b);
  const auto r = self_distance(host{}, model, robot.poses(d), nothing);
  CHECK((r.state == state::no_data && r.pairs.empty() && r.a == none && r.lower == 0));
}

TEST_CASE("Another robot in the same frame is a cloud for each of its links, and the answer names the link") {
  verdict v;
  dice d(63);
  for (int round = 0; round < 6; ++round) {
    const chain_of_spheres one(d, 0.01, 0.5), other(d, round % 2 == 0 ? 0 : 0.03, 0.5);
    const auto its = one.model(), obstacle = other.model();
    const auto poses = one.poses(d);
    auto there = other.poses(d);
    for (auto& pose : there) pose = shifted(0.9, 0.2, 0) * pose;
    const auto r = ask(host{}, its, poses, as_balls(obstacle, there), min_distance{});
    const auto [least, a, b] = least_of(one, poses, other, there);
    v.require(r.part == a && r.cloud == b, "link", r.part, " and the other's link", r.cloud);
    v.require(std::abs(r.distance - least) < 1e-5, "at", r.distance, " and by the loop at", least);
    const wide is = std::max(least, wide(0));
    v.require(r.lower <= is && is <= r.upper && (r.state == state::collision || r.lower < is - 0.0099L), "the bracket");
    const auto& spheres = obstacle.parts()[r.cloud].tree;
    const auto center =
        there[r.cloud] * Eigen::Vector3d(spheres.primitives[r.point].center.x, spheres.primitives[r.point].center.y,
                                         spheres.primitives[r.point].center.z);
    v.require((center - Eigen::Vector3d(r.at.x, r.at.y, r.at.z)).norm() < 1e-5, "where");
  }
  const chain_of_spheres robot(d, 0, 1);
  const auto model = robot.model();
  CHECK_THROWS_WITH(as_balls(model, std::vector<Eigen::Isometry3d>(2, shifted(0, 0, 0))),
                    Catch::Matchers::Contains("parts, but 2 poses"));
}

}  // namespace self_distance_test
