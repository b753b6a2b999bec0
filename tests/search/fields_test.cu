// SPDX-License-Identifier: BSD-3-Clause
// Fields that a device samples and reads.
#include "search/fielded.hpp"

#include <clearance/device.cuh>

namespace fields_device_test {

TEST_CASE("On a device a field's bounds contain the distance, and change no answer") {
  testing::check_fields(clearance::device{});
}

}  // namespace fields_device_test
