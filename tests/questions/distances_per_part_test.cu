// SPDX-License-Identifier: BSD-3-Clause
// On a device, every part's distances are those of a plain loop.
#include "support/brute_per_part.hpp"
#include "support/frames_device.cuh"

#include <clearance/device.cuh>
#include <clearance/volume/sphere.hpp>

namespace distances_per_part_test {

using namespace testing;

TEST_CASE("On a device every part's distances are brute force's, to the bit") {
  per_part_cases cases;
  hold_in_all_scenes<clearance::sphere, inner_sphere>(cases, clearance::device{});
  CHECK((cases.near > 1000 && cases.far > 1000));
}

TEST_CASE("Prepared, every part's distances are on a device in every frame the host's, and in a graph") {
  per_part_cases cases;
  hold_in_every_frame_on_a_device(cases, 126);
}

}  // namespace distances_per_part_test
