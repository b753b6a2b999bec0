// SPDX-License-Identifier: BSD-3-Clause
// Fields that a device samples and reads.
#include "search/fielded.hpp"

#include <clearance/device.cuh>

namespace fields_device_test {

TEST_CASE("On a device a field's bounds contain the distance, and change no answer") {
  testing::check_fields(clearance::device{});
}

TEST_CASE("A tree too deep for a device's stack has no field there, and says so") {
  testing::dice d(437);
  auto part = clearance::make_part(clearance::build<clearance::sphere>(testing::random_spheres(d, 50, 0.4)), 0, 0);
  part.tree.depth = 64, part.tree.width = 2;  // as a deeper tree would say
  const clearance::model robot{std::vector{part}};
  CHECK(clearance::with_fields(clearance::device{}, robot).without[0] ==
        "its tree needs a stack of 65 entries, too many for a device; sample its field on a host");
  CHECK(clearance::with_fields(clearance::host{}, robot).without[0].empty());
}

}  // namespace fields_device_test
