// SPDX-License-Identifier: BSD-3-Clause
// Questions about cropped clouds say what they say about clouds whose other points are none; and those are counted.
#include "combinations/sources.hpp"
#include "support/product.hpp"
#include "support/same_answer.hpp"

#include <clearance/frames/cropped_clouds.hpp>
#include <clearance/points/any_points.hpp>
#include <clearance/questions/certain_distance.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/questions/unseen.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

namespace cropped_questions_test {

using namespace testing;
using clearance::any_points, clearance::crop, clearance::drop_reason, clearance::host, clearance::placed,
    clearance::point_span;

namespace {

constexpr int cropped = int(drop_reason::cropped), not_finite = int(drop_reason::not_finite);

/// Counts that say `cropped` of what `bare` calls not finite.
template <class Counts>
void recount(Counts& bare, std::uint64_t count) {
  bare.dropped[not_finite] -= count;
  bare.dropped[cropped] += count;
}

/// As a source of any kind, so that a question is compiled once.
template <class S>
placed<any_points> any(const placed<S>& cloud) {
  return {cloud.source, cloud.pose};
}

struct before_a_robot : combinations::scene_before_a_robot {
  decltype(make_model<clearance::sphere>(s, {}, clearance::wrapped{})) robot =
      make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  placed<point_span> cloud{spots(true), at_pose};
  crop where = crop().height(-0.6, 0.7).without_plane({0.1, 0, 1}, 0.1, 0.1).outside({0.2, 0, -1}, {0.6, 0.5, 1});
  decltype(clearance::cropped_clouds(cloud, where)) some = clearance::cropped_clouds(cloud, where);

  /// The same points, of which those that are invalid in `source` are none, and how many more these are.
  template <class S>
  std::pair<std::vector<vec3>, std::uint64_t> without(const S& source) const {
    std::pair<std::vector<vec3>, std::uint64_t> made{at, 0};
    for (std::size_t i = 0; i < at.size(); ++i)
      if (!source[i].valid() && is_finite(at[i])) {
        made.first[i].x = clearance::not_a_number;
        ++made.second;
      }
    return made;
  }
};

}  // namespace

TEST_CASE("The least distance, zones and plans of a cropped cloud are those of the points that are left") {
  const before_a_robot b;
  const auto [left, count] = b.without(b.some.source);
  REQUIRE((count > 100 && count < 600));
  const placed<any_points> bare{point_span(left), b.at_pose}, some = any(b.some);
  const auto poses = b.configurations(1), plan = b.configurations(5);

  auto least = ask(host{2}, b.robot, poses, bare, clearance::min_distance_per_part{});
  recount(least.all, count);
  CHECK(same_answer(least, ask(host{2}, b.robot, poses, some, clearance::min_distance_per_part{})));

  const clearance::zones zones{.thresholds = {0.1, 0.3}};
  auto near = ask(host{}, b.robot, poses, bare, zones);
  recount(near.counts, count);
  CHECK(same_answer(near, ask(host{}, b.robot, poses, some, zones)));

  auto many = clearance::min_distances_result(ask(host{}, b.robot, plan, bare, clearance::min_distances{}));
  for (auto& r : many.of) recount(r, count);
  CHECK(
      same_answer(many, clearance::min_distances_result(ask(host{}, b.robot, plan, some, clearance::min_distances{}))));

  const auto nothing = ask(host{}, b.robot, poses, any(clearance::cropped_clouds(b.cloud, crop().height(50, 60))),
                           clearance::min_distance_per_part{})
                           .all;
  CHECK((nothing.state == clearance::state::no_data && nothing.lower == 0 && nothing.valid == 0 &&
         nothing.dropped[cropped] == b.at.size() - 1 && nothing.dropped[not_finite] == 1));
}

TEST_CASE("What is certain of a cropped cloud is about every point that may be where points count") {
  const before_a_robot b;
  const auto poses = b.configurations(1);
  const auto within = [&](const any_points& source) {
    return placed{clearance::uncertain(source, clearance::no_noise{}, {.shift = 0.05}), b.at_pose};
  };
  const auto some = within(b.some.source);
  const auto found = ask(host{}, b.robot, poses, some, clearance::certain_distance{});
  const auto [left, count] = b.without(some.source);
  CHECK(count < b.without(b.some.source).second);
  const auto bare = ask(host{}, b.robot, poses, within(point_span(left)), clearance::certain_distance{});
  CHECK((same_answer(bare.parts, found.parts) && bare.lower == found.lower));
  CHECK(same_answer(found.nominal, ask(host{}, b.robot, poses, any(b.some), clearance::min_distance_per_part{}).all));
}

TEST_CASE("An image is cropped as its points are, and hides what it hides") {
  const before_a_robot b;
  const auto poses = b.configurations(1), plan = b.configurations(3);
  const placed image{b.seen(true), b.camera_pose};
  const auto some = clearance::cropped_clouds(image, b.where);
  std::vector<vec3> left;
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < image.source.size(); ++i) {
    const clearance::sample s = some.source[i];
    left.push_back(s.valid() ? s.position : vec3{clearance::not_a_number, 0, 0});
    count += s.dropped == drop_reason::cropped;
  }
  REQUIRE((count > 50 && count < 500));
  point_span points(left);
  points.off = rounding_of(image.source);
  const auto same = [&](clearance::min_distance_result a, clearance::min_distance_result expected) {
    CHECK(a.dropped[cropped] == count);
    std::ranges::fill(a.dropped, 0), std::ranges::fill(expected.dropped, 0);
    CHECK(same_answer(a, expected));
  };
  const placed<any_points> shown = any(some), beside{points, b.camera_pose};
  same(ask(host{}, b.robot, poses, shown, clearance::min_distance_per_part{}).all,
       ask(host{}, b.robot, poses, beside, clearance::min_distance_per_part{}).all);
  const clearance::min_distances_result a = ask(host{}, b.robot, plan, shown, clearance::min_distances{}),
                                        e = ask(host{}, b.robot, plan, beside, clearance::min_distances{});
  for (std::size_t c = 0; c < e.of.size(); ++c) same(a.of[c], e.of[c]);

  const clearance::unseen hidden{.room = {0.3f, 4}};
  const auto whole = ask(host{}, b.robot, poses, image, hidden);
  CHECK(same_answer(whole, ask(host{}, b.robot, poses, some, hidden)));
  const std::vector<clearance::point_label> labels(image.source.size(), clearance::point_label::own);
  const placed masked{clearance::masked(image.source, labels.data()), b.camera_pose};
  CHECK(same_answer(ask(host{}, b.robot, poses, masked, hidden),
                    ask(host{}, b.robot, poses, clearance::cropped_clouds(masked, b.where), hidden)));
  CHECK(same_answer(ask(host{}, b.robot, poses, masked, hidden),
                    ask(host{}, b.robot, poses, clearance::masked_clouds(some, labels.data()), hidden)));
}

}  // namespace cropped_questions_test
