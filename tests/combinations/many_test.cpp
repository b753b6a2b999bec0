// SPDX-License-Identifier: BSD-3-Clause
// Questions about many configurations, and about each of them by itself.
#include "combinations/cells.hpp"
#include "support/catch.hpp"

namespace many_test {

using namespace combinations;

namespace {

/// Asks `many` about three configurations, and compares `of(answer, configuration)` with `by_hand(poses, clouds)`.
template <class Q, class Of, class ByHand>
void check_each(const Q& many, const Of& of, const ByHand& by_hand) {
  verdict v;
  const scene_before_a_robot before;
  const auto robot = make_model<clearance::sphere>(before.s, {}, clearance::wrapped{});
  const std::size_t parts = robot.size(), count = 3;
  const auto poses = before.configurations(count);
  const auto check = [&](const auto& clouds, const std::string& what) {
    const auto all = ask(host{}, robot, poses, clouds, many);
    for (std::size_t c = 0; c < count; ++c) {
      const std::vector its(poses.begin() + std::ptrdiff_t(c * parts),
                            poses.begin() + std::ptrdiff_t(c * parts + parts));
      v.require(same_answer(of(all, c), by_hand(robot, its, clouds)), what, ", configuration", c);
    }
  };
  using kinds_asked = asked_here<Q>;
  for_each_kind(kinds_asked(), [&]<class S>() {
    clouds_of<kinds_asked> one;
    one.emplace_back(before.cloud<S>(true, 0.02f));
    check(one, name_of<S>);
  });
  check(before.all(kinds_asked(), [](std::size_t) { return true; }, 0.02f), "several");
}

}  // namespace

TEST_CASE("min_distances: each cell is asked, and says what is composed by hand") {
  check_cells("min_distances", clearance::min_distances{.d_max = 0.3, .radii = {0.02}}, 2);
  check_each(
      clearance::min_distances{}, [](const auto& all, std::size_t c) { return all.of[c]; },
      [](const auto& robot, const auto& poses, const auto& clouds) {
        return ask(host{}, robot, poses, clouds, clearance::min_distance{});
      });
}
TEST_CASE("min_distances_per_part: each cell is asked, and says what is composed by hand") {
  check_cells("min_distances_per_part", clearance::min_distances_per_part{.d_max = 0.3}, 2);
  check_each(
      clearance::min_distances_per_part{},
      [](const auto& all, std::size_t c) {
        const auto its = all.of(c);
        return std::vector(its.begin(), its.end());
      },
      [](const auto& robot, const auto& poses, const auto& clouds) {
        std::vector<clearance::min_distance_result> each;
        for (std::uint32_t k = 0; k < robot.size(); ++k) {
          const std::vector pose{poses[k]};
          each.push_back(ask(host{}, robot.view().part(k), pose, clouds, clearance::min_distance{}));
          if (each.back().part != clearance::none) each.back().part = k;
        }
        return each;
      });
}
TEST_CASE("in_collisions: each cell is asked, and says what is composed by hand") {
  check_cells("in_collisions", clearance::in_collisions{{0.02}}, 2);
  check_each(
      clearance::in_collisions{{0.05}}, [](const auto& all, std::size_t c) { return all.of[c]; },
      [](const auto& robot, const auto& poses, const auto& clouds) {
        return ask(host{}, robot, poses, clouds, clearance::in_collision{{0.05}}).state;
      });
}

}  // namespace many_test
