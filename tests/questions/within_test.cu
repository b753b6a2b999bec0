// SPDX-License-Identifier: BSD-3-Clause
// On a device, points within a distance are those of a plain loop, and a long list is the host's.
#include "support/brute_within.hpp"
#include "support/frames_device.cuh"

#include <clearance/device.cuh>
#include <clearance/volume/sphere.hpp>

namespace within_test {

using namespace testing;
using clearance::device, clearance::host, clearance::placed, clearance::point_span, clearance::within;

TEST_CASE("On a device points within a distance are all of them, in order, and a long list is whole") {
  within_cases cases;
  hold_in_all_scenes<clearance::sphere, inner_sphere>(cases, device{});
  CHECK(cases.found > 10000);
  verdict v;
  const auto s = two_balls();
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const std::vector cloud{placed{point_span(s.points)}};
  require_same(ask(device{}, model.on(device{}), s.poses, cloud, within{{10}}),
               ask(host{}, model, s.poses, cloud, within{{10}}), v, "many");
}

TEST_CASE("A prepared list says on a device in every frame what the host says, and in a graph") {
  within_cases cases;
  hold_in_every_frame_on_a_device(cases, 122);
  CHECK(cases.longest > 1 << 16);
}

}  // namespace within_test
