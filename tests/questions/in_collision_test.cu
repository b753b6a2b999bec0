// SPDX-License-Identifier: BSD-3-Clause
// On a device, the first point within a margin is that of a plain loop, and in a crowd the host's.
#include "support/brute_collision.hpp"
#include "support/frames_device.cuh"

#include <clearance/device.cuh>
#include <clearance/volume/sphere.hpp>

namespace in_collision_test {

using namespace testing;
using clearance::device, clearance::host, clearance::in_collision, clearance::point_span, clearance::state;

TEST_CASE("On a device a point within a margin is found, the first that is certain, in all scenes") {
  collision_cases cases;
  hold_in_all_scenes<clearance::sphere, inner_sphere>(cases, device{});
  CHECK((cases.count(state::free) > 5 && cases.count(state::collision) > 5));
}

TEST_CASE("In a crowd the first point is found again and again") {
  verdict v;
  const device gpu;
  const auto s = crowd(98);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto there = model.on(gpu);
  for (const double margin : {0.0, 0.001, 0.3}) {
    const auto expected = ask(host{}, model, s.poses, point_span(s.points), in_collision{{margin}});
    CHECK(expected.state == state::collision);
    for (int k = 0; k < 5; ++k)
      require_same(ask(gpu, there, s.poses, point_span(s.points), in_collision{{margin}}), expected, v, "crowd");
  }
}

TEST_CASE("A prepared question of collision says on a device in every frame what the host says, and in a graph") {
  collision_cases cases;
  hold_in_every_frame_on_a_device(cases, 123);
  CHECK((cases.count(state::free) > 0 && cases.count(state::collision) > 0 && cases.count(state::no_data) > 0));
}

}  // namespace in_collision_test
