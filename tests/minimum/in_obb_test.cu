// SPDX-License-Identifier: BSD-3-Clause
#include "support/product_device.cuh"

#include <clearance/volume/obb.hpp>

namespace in_obb_test {

using namespace testing;
using clearance::obb;

TEST_CASE("Inner spheres in oriented boxes, near first, from a span: the device is brute force, bit for bit") {
  check_on_device<inner_sphere, obb, clearance::near_first>(pick_span{});
}

TEST_CASE("Triangles in oriented boxes, recursive, from records of floats: the device is brute force, bit for bit") {
  check_on_device<triangle, obb, clearance::recursive>(pick_floats{});
}

TEST_CASE("Inner spheres in oriented boxes, stack, from records of doubles: the device is brute force, bit for bit") {
  check_on_device<inner_sphere, obb, clearance::stack>(pick_doubles{});
}

TEST_CASE("Triangles in oriented boxes, near first, from a 16-bit image: the device is brute force, bit for bit") {
  check_on_device<triangle, obb, clearance::near_first>(pick_raw{});
}

TEST_CASE("Inner spheres in oriented boxes, recursive, from a float image: the device is brute force, bit for bit") {
  check_on_device<inner_sphere, obb, clearance::recursive>(pick_metres{});
}

}  // namespace in_obb_test
