// SPDX-License-Identifier: BSD-3-Clause
// Points within a distance are those of a plain loop over all points and primitives, in order.
#include "support/brute_within.hpp"
#include "support/question_laws.hpp"

#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace within_test {

using namespace testing;
using clearance::host, clearance::placed, clearance::point_span, clearance::within;

TEST_CASE("Points within a distance of inner spheres are all of them, in order") {
  within_cases cases;
  hold_in_all_scenes<clearance::sphere, inner_sphere>(cases, host{}, host{1});
  CHECK(cases.found > 10000);
}
TEST_CASE("Points within a distance of triangles are all of them, in order") {
  within_cases cases;
  hold_in_all_scenes<clearance::aabb, triangle>(cases, host{}, host{1});
  CHECK(cases.found > 10000);
}

TEST_CASE("A list longer than its first room is whole, and one of the caller's says that it was cut") {
  const auto s = two_balls();
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const std::vector cloud{placed{point_span(s.points)}};
  const auto all = ask(host{}, model, s.poses, cloud, within{{10}});
  CHECK(all.pairs.size() == 100000);
  std::vector<clearance::pair_distance> pairs(100);
  unsigned long long count = 0;
  clearance::point_counts counts;
  enqueue(host{}, model, s.poses, cloud, within{{10, 10}}, {pairs.data(), pairs.size(), &count, &counts});
  CHECK((count == 100000 && counts.valid == 50000 && pairs[99].distance > 0));
  CHECK_THROWS_AS(ask(host{}, model, s.poses, cloud, within{{clearance::not_a_number}}), std::invalid_argument);
  CHECK_THROWS_AS(ask(host{}, model, s.poses, cloud, within{{1, 1, 1}}), std::invalid_argument);
}

TEST_CASE("A prepared list says in every frame what one call says, and goes on after one that is refused") {
  within_cases cases;
  hold_in_every_frame(cases, host{}, 5, 112);
  CHECK(cases.longest > 1 << 16);
}

}  // namespace within_test
