// SPDX-License-Identifier: BSD-3-Clause
#include "support/product_device.cuh"

#include <clearance/volume/aabb.hpp>

namespace in_aabb_test {

using namespace testing;
using clearance::aabb;

TEST_CASE("Triangles in axis-aligned boxes, stack, from a span: the device is brute force, bit for bit") {
  check_on_device<triangle, aabb, clearance::stack>(pick_span{});
}

TEST_CASE(
    "Inner spheres in axis-aligned boxes, near first, from records of floats: the device is brute force, bit for bit") {
  check_on_device<inner_sphere, aabb, clearance::near_first>(pick_floats{});
}

TEST_CASE(
    "Triangles in axis-aligned boxes, recursive, from records of doubles: the device is brute force, bit for bit") {
  check_on_device<triangle, aabb, clearance::recursive>(pick_doubles{});
}

TEST_CASE("Inner spheres in axis-aligned boxes, stack, from a 16-bit image: the device is brute force, bit for bit") {
  check_on_device<inner_sphere, aabb, clearance::stack>(pick_raw{});
}

TEST_CASE("Triangles in axis-aligned boxes, near first, from a float image: the device is brute force, bit for bit") {
  check_on_device<triangle, aabb, clearance::near_first>(pick_metres{});
}

}  // namespace in_aabb_test
