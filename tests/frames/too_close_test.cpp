// SPDX-License-Identifier: BSD-3-Clause
// Points too close for the sensor to measure are counted, and then nothing is free.
#include "support/catch.hpp"
#include "support/laws.hpp"
#include "support/too_close_frame.hpp"

#include <clearance/make_model.hpp>
#include <clearance/minimum/merge.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/traversal/near_first.hpp>
#include <clearance/volume/sphere.hpp>

namespace too_close_test {

using namespace testing;
using clearance::drop_reason, clearance::host, clearance::min_distance, clearance::state;

namespace {

const std::vector poses{Eigen::Isometry3d::Identity()};
const auto robot = clearance::make_model<clearance::sphere>(ball_before_it);

}  // namespace

TEST_CASE("A depth of -inf is too close, +inf and NaN are not, and the survey says what each pixel does") {
  const too_close_frame frame(20, 3, 7);
  verdict v;
  for (const bool near : {true, false}) {
    auto image = frame.image();
    auto rays = frame.with_rays();
    image.minus_infinity_is_near = rays.minus_infinity_is_near = near;
    std::uint32_t all[clearance::drop_reasons] = {};
    for (std::size_t begin = 0; begin < image.size(); begin += clearance::surveyed_points) {
      clearance::extent box;
      std::uint32_t dropped[clearance::drop_reasons] = {}, expected[clearance::drop_reasons] = {};
      for (std::size_t i = begin; i < begin + clearance::surveyed_points; ++i) {
        v.require(image[i].dropped == rays[i].dropped, "pixel ", i, " with a ray");
        if (!image[i].valid()) ++expected[int(image[i].dropped)], ++all[int(image[i].dropped)];
      }
      v.require(image.survey(begin, box, dropped) && std::ranges::equal(dropped, expected), "the tile from ", begin,
                " on");
    }
    CHECK((all[int(drop_reason::too_close)] == (near ? 20u : 0u) &&
           all[int(drop_reason::not_finite)] == (near ? 10u : 30u)));
  }
}

TEST_CASE("Nothing is free in a frame with something too close") {
  const too_close_frame clear(0, 9), blocked(1);
  const auto free = ask(host{}, robot, poses, clear.image(), min_distance{}),
             r = ask(host{}, robot, poses, blocked.image(), min_distance{});
  CHECK((free.state == state::free && free.lower > 1.7f));
  CHECK((r.state == state::possible && r.lower == 0 && r.distance == free.distance &&
         r.dropped[int(drop_reason::too_close)] == 1));
  CHECK(clearance::ask(host{}, robot, poses, blocked.image(), clearance::min_distance_per_part{}).all.state ==
        state::possible);
  CHECK(ask(clearance::plain{host{}, clearance::near_first{}}, robot, poses, blocked.image(), min_distance{}).state ==
        state::possible);
  auto told = blocked.image();
  told.minus_infinity_is_near = false;
  CHECK(ask(host{}, robot, poses, told, min_distance{}).state == state::free);
  CHECK(clearance::ask(host{}, robot, poses, clear.image(), clearance::in_collision{{0.1}}).state == state::free);
  CHECK(clearance::ask(host{}, robot, poses, blocked.image(), clearance::in_collision{{0.1}}).state == state::possible);
  CHECK(clearance::ask(host{}, robot, poses, clear.image(), clearance::zones{.thresholds = {0.1}}).innermost() == 1);
  CHECK(clearance::ask(host{}, robot, poses, blocked.image(), clearance::zones{.thresholds = {0.1}}).innermost() == 0);
  for (const real d_max : {clearance::infinity, real(0.1)}) {
    const auto ask = [&](const auto& frame) {
      return clearance::ask(host{}, robot, poses, frame.image(), clearance::min_distances{.d_max = d_max});
    };
    CHECK((ask(clear).of[0].state == state::free && ask(clear).first_below(0.05) == 1));
    CHECK((ask(blocked).of[0].state == state::possible && ask(blocked).of[0].lower == 0 &&
           ask(blocked).first_below(0.05) == 0));
  }
  const clearance::straight_motion still(poses, poses);
  CHECK(motion_clearance(host{}, robot, still, clear.image()).state == state::free);
  const auto moving = motion_clearance(host{}, robot, still, blocked.image());
  CHECK((moving.state == state::possible && moving.lower == 0));
  const auto supported =
      clearance::ask(host{}, robot, poses, blocked.image(), clearance::min_distance_supported{.radius = 0.1});
  CHECK((supported.state == state::possible && supported.lower == 0 && supported.distance == free.distance));
}

TEST_CASE("One camera that is covered leaves nothing free for all") {
  const too_close_frame clear(0), blocked(1);
  const auto both = std::vector{clear.image(), blocked.image()};
  CHECK(ask(host{}, robot, poses, both, min_distance{}).state == state::possible);
  const std::vector<float> covered(64 * 48, -clearance::infinity);
  const clearance::depth_image<float> nothing(covered.data(), 64, 48, {60, 60, 31.5, 23.5});
  const auto a = ask(host{}, robot, poses, clear.image(), min_distance{}),
             b = ask(host{}, robot, poses, nothing, min_distance{});
  CHECK((a.state == state::free && b.state == state::no_data &&
         b.dropped[int(drop_reason::too_close)] == covered.size()));
  CHECK((merge(a, b).state == state::possible && merge(b, a).lower == 0));
}

}  // namespace too_close_test
