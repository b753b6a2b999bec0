// SPDX-License-Identifier: BSD-3-Clause
// Fields that a device samples and reads.
#include "clearance/fielded.hpp"

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

TEST_CASE("Where a device's memory ends there is no field, a sentence says so, and the device is as it was") {
  testing::dice d(438);
  const clearance::model robot{std::vector{
      clearance::make_part(clearance::build<clearance::sphere>(testing::random_spheres(d, 50, 0.4)), 0, 0)}};
  const clearance::device gpu{};
  std::size_t free = 0, all = 0;
  REQUIRE(cudaMemGetInfo(&free, &all) == cudaSuccess);
  constexpr std::size_t gib = std::size_t(1) << 30;
  if (free < 2 * gib) return;
  {
    const clearance::device_buffer<std::byte> held(free - gib, gpu.id);
    const auto made = clearance::with_fields(gpu, robot, {4 * gib});
    CHECK(made.without[0] == "there is not enough memory to sample its field");
    CHECK(made.model.view().fields == nullptr);
  }
  CHECK(cudaPeekAtLastError() == cudaSuccess);
  CHECK(clearance::with_fields(gpu, robot).without[0].empty());
}

}  // namespace fields_device_test
