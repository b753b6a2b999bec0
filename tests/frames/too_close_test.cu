// SPDX-License-Identifier: BSD-3-Clause
// On a device, too, nothing is free in a frame with something too close.
#include "support/product_device.cuh"
#include "support/too_close_frame.hpp"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/volume/sphere.hpp>

namespace too_close_test {

using namespace testing;
using clearance::device, clearance::drop_reason, clearance::host, clearance::min_distance, clearance::state;

TEST_CASE("On a device what is too close is counted, and leaves nothing free") {
  const device gpu;
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const auto robot = clearance::make_model<clearance::sphere>(ball_before_it);
  const auto there = robot.on(gpu);
  for (const std::size_t near : {0, 1, 400}) {
    const too_close_frame frame(near, 50, 3);
    const auto r = ask(gpu, there, poses, frame.image(), min_distance{});
    CHECK(same_result(r, ask(host{}, robot, poses, frame.image(), min_distance{})));
    CHECK(r.dropped[int(drop_reason::too_close)] == near);
    CHECK(r.state == (near == 0 ? state::free : state::possible));
    CHECK(same_result(clearance::ask(gpu, there, poses, frame.image(), clearance::min_distance_per_part{}).all,
                      clearance::ask(host{}, robot, poses, frame.image(), clearance::min_distance_per_part{}).all));
    CHECK(clearance::ask(gpu, there, poses, frame.image(), clearance::in_collision{{0.1}}).state ==
          (near == 0 ? state::free : state::possible));
  }
}

}  // namespace too_close_test
