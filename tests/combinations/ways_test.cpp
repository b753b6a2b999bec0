// SPDX-License-Identifier: BSD-3-Clause
// A way between two places: what motion_clearance says of each kind of source.
#include "combinations/cells.hpp"
#include "support/catch.hpp"

#include <clearance/motion_clearance.hpp>

namespace ways_test {

using namespace combinations;

namespace {

using clearance::min_distance_per_part, clearance::motion_clearance, clearance::motion_clearance_options,
    clearance::motion_clearance_result;

bool same(const motion_clearance_result& a, const motion_clearance_result& b) {
  return a.state == b.state && same_bits(a.lower, b.lower) && same_bits(a.upper, b.upper) && a.time == b.time &&
         same_answer(a.nearest, b.nearest) && a.from == b.from && a.to == b.to && a.part == b.part &&
         a.queries == b.queries && a.settled == b.settled;
}

}  // namespace

TEST_CASE("a way between two: each kind of source is asked, and says what is composed by hand") {
  verdict v;
  const scene_before_a_robot before;
  const auto robot = make_model<clearance::sphere>(before.s, {}, clearance::wrapped{});
  const auto ends = before.configurations(2);
  const std::span all(ends);
  const clearance::straight_motion way(all.first(robot.size()), all.last(robot.size())),
      still(all.first(robot.size()), all.first(robot.size()));
  using kinds_asked = asked_here<min_distance_per_part>;
  static_assert(std::is_same_v<taken<min_distance_per_part>, all_kinds>);
  const motion_clearance_options some{.tolerance = 0.05, .most_queries = 40};
  const auto of = [&](const auto& clouds, const std::string& what) {
    const motion_clearance_result r = motion_clearance(host{}, robot, way, clouds, some);
    clearance::query prepared(host{2}, robot, min_distance_per_part{});
    v.require(same(r, motion_clearance(prepared, robot, way, clouds, some)), what, ": prepared");
    const auto there = way.at(r.time, clearance::detail::facts_of(robot)).poses;
    const auto found = ask(host{}, robot, there, clouds, min_distance_per_part{});
    v.require(same_answer(r.nearest, found.all), what, ": another answer at that time");
    v.require(r.lower <= found.all.lower && r.upper >= found.all.upper, what, ": another bracket");
    // Who does not move is as near as a question says.
    const motion_clearance_result stays = motion_clearance(host{}, robot, still, clouds, {.most_queries = 1});
    const auto now = ask(host{}, robot, before.s.poses, clouds, min_distance_per_part{}).all;
    v.require(same_answer(stays.nearest, now) && stays.lower <= now.lower && stays.lower > now.lower - 1e-5f, what,
              ": standing still it is", stays.lower, " and not", now.lower);
    return r;
  };
  const auto one = [&]<class S>(real radius) {
    clouds_of<kinds_asked> cloud;
    cloud.emplace_back(before.cloud<S>(true, radius));
    return of(cloud, name_of<S>);
  };
  const auto vague = [](motion_clearance_result r) {
    r.upper = clearance::infinity;
    if (r.state == clearance::state::collision) r.state = clearance::state::possible;
    return r;
  };
  v.require(same(one.operator()<image>(0), one.operator()<listed_samples>(0)), "an image and its points");
  v.require(same(one.operator()<balls>(0), vague(one.operator()<points>(0))), "balls without a radius");
  v.require(same(one.operator()<uncertain_room>(0), vague(one.operator()<room>(0))), "a room that is not uncertain");
  real least = clearance::infinity;
  for_each_kind(kinds_asked(), [&]<class S>() { least = std::min(least, one.operator()<S>(0.02f).lower); });
  const auto several = of(before.all(kinds_asked(), [](std::size_t) { return true; }, 0.02f), "several");
  v.require(several.lower <= least + real(some.tolerance), "several clouds are farther than one of them");
}

}  // namespace ways_test
