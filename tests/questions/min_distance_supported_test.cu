// SPDX-License-Identifier: BSD-3-Clause
// On a device, the nearest point that others confirm is the first of all, and beside images the host's.
#include "support/brute_support.hpp"
#include "support/frames_device.cuh"

#include <clearance/device.cuh>
#include <clearance/volume/sphere.hpp>

namespace min_distance_supported_test {

using namespace testing;
using clearance::device;

TEST_CASE("On a device the nearest point that others confirm is the first of all") {
  supported_cases cases;
  hold_in_all_scenes<clearance::sphere, inner_sphere>(cases, device{});
  CHECK((cases.isolated > 1000 && cases.confirmed > 20));
  like_the_host_beside_images<clearance::sphere, inner_sphere>(cases, device{});
}

TEST_CASE("Prepared, the nearest confirmed point is on a device in every frame the host's") {
  supported_cases cases;
  hold_in_every_frame_on_a_device(cases, 125);
}

}  // namespace min_distance_supported_test
