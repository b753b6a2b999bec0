// SPDX-License-Identifier: BSD-3-Clause
// Questions about what images hide, and the same of hidden room as a source.
#include "combinations/cells.hpp"
#include "support/catch.hpp"

namespace images_test {

using namespace combinations;

namespace {

using clearance::min_distance, clearance::min_distance_per_part, clearance::seen_and_unseen, clearance::unseen,
    clearance::unseen_result;

bool same(const unseen_result& a, const unseen_result& b) {
  bool all = same_answer(a.all, b.all) && same_answer(a.own_shadow, b.own_shadow) && a.parts.size() == b.parts.size();
  for (std::size_t k = 0; all && k < a.parts.size(); ++k) {
    const clearance::unseen_part &x = a.parts[k], &y = b.parts[k];
    all = same_answer(static_cast<const clearance::part_witness&>(x), static_cast<const clearance::part_witness&>(y)) &&
          same_bits(x.lower, y.lower) && same_bits(x.out_of_view, y.out_of_view) && same_bits(x.to_edge, y.to_edge);
  }
  return all;
}
/// What it says if the image is uncertain, but by nothing.
unseen_result vague(unseen_result r) {
  if (r.all.state == clearance::state::unknown) r.all.state = clearance::state::possible;
  r.all.upper = clearance::infinity;
  return r;
}

template <class Robot, class S>
void check_image(verdict& v, const Robot& robot, const scene_before_a_robot& before, const unseen& q) {
  const auto& poses = before.s.poses;
  const placed<S> camera = before.cloud<S>(true, 0.02f);
  const unseen_result its = ask(host{}, robot, poses, camera, q);
  const std::string what = name_of<S>;
  using hides = std::conditional_t<std::is_same_v<S, image>, room, uncertain_room>;
  auto behind = before.cloud<hides>(true, 0.02f);
  const double half = std::hypot(1 / 25.0, 1 / 25.0) / 2;  // of a pixel's diagonal at z = 1
  if constexpr (std::is_same_v<S, image>)
    behind.source.half_pixel = clearance::rounded_up(half);
  else
    behind.source = uncertain_room(
        [&] {
          room wide = before.behind(true);
          wide.half_pixel = clearance::rounded_up(half);
          return wide;
        }(),
        {0.02f});
  const auto least = ask(host{}, robot, poses, behind, min_distance_per_part{});
  v.require(its.all.distance == least.all.distance && its.all.point == least.all.point &&
                its.all.part == least.all.part && its.all.valid == least.all.valid,
            what, ": another distance than the room's");
  for (std::size_t k = 0; k < least.parts.size(); ++k)
    v.require(its.parts[k].distance == least.parts[k].distance && its.parts[k].point == least.parts[k].point, what,
              ": another distance of part", k);
  clearance::query prepared(host{2}, robot, q);
  for (int time = 0; time < 2; ++time) v.require(same(its, prepared(poses, camera)), what, ": prepared");
  unseen_result twice = ask(host{}, robot, poses, std::vector(2, camera), q), same_twice = its;
  same_twice.all.upper = clearance::infinity;  // of several cameras it is not known
  same_twice.all.seen *= 2, same_twice.all.valid *= 2;
  for (auto& n : same_twice.all.dropped) n *= 2;
  v.require(same(twice, same_twice), what, ": the same camera twice");
}

}  // namespace

TEST_CASE("unseen and seen_and_unseen: each cell is asked, and says what is composed by hand") {
  verdict v;
  const scene_before_a_robot before;
  const auto robot = make_model<clearance::sphere>(before.s, {}, clearance::wrapped{});
  const auto& poses = before.s.poses;
  const unseen q{.room = {0.3f, 4}, .places = true, .edges = true};
  static_assert(std::is_same_v<taken<unseen>, kinds<image, uncertain_image>>);
  static_assert(std::is_same_v<taken<seen_and_unseen>, kinds<image>>);
  for_each_kind(taken<unseen>(),
                [&]<class S>() { check_image<std::remove_const_t<decltype(robot)>, S>(v, robot, before, q); });
  const auto camera = before.cloud<image>(true);
  v.require(same(ask(host{}, robot, poses, before.cloud<uncertain_image>(true), q),
                 vague(ask(host{}, robot, poses, camera, q))),
            "an image that is not uncertain");

  seen_and_unseen both;
  static_cast<unseen&>(both) = q;
  for (const auto& clouds : {std::vector(1, camera), std::vector(2, camera)}) {
    const clearance::seen_and_unseen_result r = ask(host{}, robot, poses, clouds, both);
    v.require(same(r, ask(host{}, robot, poses, clouds, q)), "unseen of both");
    v.require(same_answer(r.seen, ask(host{}, robot, poses, clouds, min_distance{})), "seen of both");
  }

  unseen wide = q;
  wide.radii = {0.01, 0.03, 0.02};
  std::vector<std::remove_cvref_t<decltype(robot.parts()[0])>> parts(robot.parts().begin(), robot.parts().end());
  for (std::size_t k = 0; k < parts.size(); ++k) parts[k].facts = clearance::widened(parts[k].facts, wide.radii[k]);
  const clearance::model widened(parts);
  const auto one = ask(host{}, robot, poses, camera, wide), by_hand = ask(host{}, widened, poses, camera, q);
  v.require(one.all.lower == by_hand.all.lower && one.all.upper == by_hand.all.upper, "radii and tolerances");
}

TEST_CASE("a cloud that may be of any kind is asked about what it hides, if it is an image") {
  const scene_before_a_robot before;
  const auto robot = make_model<clearance::sphere>(before.s, {}, clearance::wrapped{});
  using either = std::vector<std::variant<placed<points>, placed<image>>>;
  static_assert(clearance::why_not<unseen, either>() == nullptr);
  static_assert(clearance::why_not<unseen, std::vector<placed<points>>>() != nullptr);
  const unseen q{.room = {0.3f, 4}};
  const either images{before.cloud<image>(true)}, spots{before.cloud<points>(true)};
  CHECK(same(ask(host{}, robot, before.s.poses, images, q),
             ask(host{}, robot, before.s.poses, before.cloud<image>(true), q)));
  CHECK_THROWS_WITH(ask(host{}, robot, before.s.poses, spots, q),
                    "clearance: unseen is asked about depth images, and cloud 0 is none");
}

}  // namespace images_test
