// SPDX-License-Identifier: BSD-3-Clause
// Questions that name what was found before, or that write into memory of the caller's.
#include "combinations/cells.hpp"
#include "support/catch.hpp"

namespace witnesses_test {

using namespace combinations;

namespace {

using clearance::collect, clearance::min_distance_per_part, clearance::part_minimum, clearance::part_witnesses,
    clearance::within;

}  // namespace

TEST_CASE("part_witnesses: each cell is asked, and says what is composed by hand") {
  verdict v;
  const scene_before_a_robot before;
  const auto robot = make_model<clearance::sphere>(before.s, {}, clearance::wrapped{});
  const auto& poses = before.s.poses;
  using kinds_asked = asked_here<part_witnesses>;
  static_assert(std::is_same_v<kinds_asked, asked_here<min_distance_per_part>>);
  const auto of = [&](const auto& clouds) {
    const std::vector<part_minimum> minima = ask(host{}, robot, poses, clouds, min_distance_per_part{}).parts;
    clearance::query prepared(host{2}, robot, part_witnesses{minima});
    const auto found = prepared(poses, clouds);
    v.require(same_answer(found, ask(host{}, robot, poses, clouds, part_witnesses{minima})), "prepared");
    v.require(writes_the_same(host{}, prepared, poses, clouds, part_witnesses{minima}, found, robot.size(), 0),
              "enqueued");
    for (std::size_t k = 0; k < minima.size(); ++k)
      v.require(found[k].distance == minima[k].distance && found[k].point == minima[k].point, "another pair");
    return found;
  };
  const auto one = [&]<class S>() {
    clouds_of<kinds_asked> cloud;
    cloud.emplace_back(before.cloud<S>(true));
    return of(cloud);
  };
  v.require(same_answer(one.operator()<image>(), one.operator()<listed_samples>()), "an image and its points");
  v.require(same_answer(one.operator()<balls>(), one.operator()<points>()), "balls without a radius");
  v.require(same_answer(one.operator()<uncertain_room>(), one.operator()<room>()), "a room that is not uncertain");
  const auto all = of(before.all(kinds_asked(), [](std::size_t) { return true; }, 0.02f));
  for (std::uint32_t c = 0; c < 6; ++c) {
    auto alone = of(before.all(kinds_asked(), [c](std::size_t k) { return k == c; }, 0.02f));
    for (std::size_t k = 0; k < all.size(); ++k)
      v.require(all[k].cloud != c || same_answer(all[k], alone[k]), "several clouds and each by itself: cloud", c);
  }
}

TEST_CASE("collect: each cell is asked, and says what is composed by hand") {
  verdict v;
  const scene_before_a_robot before;
  const auto robot = make_model<clearance::sphere>(before.s, {}, clearance::wrapped{});
  const auto& poses = before.s.poses;
  const std::vector<real> reaches(robot.size(), clearance::frames::largest_within(0.1));
  const auto check = [&](const auto& clouds, const std::string& what) {
    const auto expected = ask(host{}, robot, poses, clouds, within{{0.1}});
    for (const char* form : {"once", "prepared", "enqueued"}) {
      std::vector<clearance::pair_distance> pairs(20000);
      unsigned long long count = 0;
      const collect q{clearance::pairwise::listed{pairs.data(), &count, pairs.size(), reaches.data()}};
      clearance::point_counts counts;
      clearance::query prepared(host{}, robot, q);
      if (form[0] == 'o')
        counts = ask(host{}, robot, poses, clouds, q);
      else if (form[0] == 'p')
        counts = prepared(poses, clouds);
      else
        prepared.enqueue(poses, clouds, {&counts});
      clearance::within_result its;
      pairs.resize(std::min<std::size_t>(count, pairs.size()));
      its.pairs = pairs;
      clearance::pairwise::put_in_order(its, robot.size());
      v.require(same_answer(its.pairs, expected.pairs) && same_answer(counts, expected.counts), what, ": ", form);
    }
  };
  using kinds_asked = asked_here<within>;
  static_assert(std::is_same_v<kinds_asked, asked_here<collect<clearance::pairwise::listed>>>);
  for_each_kind(kinds_asked(), [&]<class S>() {
    clouds_of<kinds_asked> one;
    one.emplace_back(before.cloud<S>(true, 0.02f));
    check(one, name_of<S>);
  });
  check(before.all(kinds_asked(), [](std::size_t) { return true; }, 0.02f), "several");
}

}  // namespace witnesses_test
