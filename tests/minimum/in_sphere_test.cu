// SPDX-License-Identifier: BSD-3-Clause
#include "support/product_device.cuh"

#include <clearance/volume/sphere.hpp>

namespace in_sphere_test {

using namespace testing;
using clearance::sphere;

TEST_CASE("Inner spheres in spheres, recursive, from a span: the device is brute force, bit for bit") {
  check_on_device<inner_sphere, sphere, clearance::recursive>(pick_span{});
}

TEST_CASE("Triangles in spheres, stack, from records of floats: the device is brute force, bit for bit") {
  check_on_device<triangle, sphere, clearance::stack>(pick_floats{});
}

TEST_CASE("Inner spheres in spheres, near first, from records of doubles: the device is brute force, bit for bit") {
  check_on_device<inner_sphere, sphere, clearance::near_first>(pick_doubles{});
}

TEST_CASE("Triangles in spheres, recursive, from a 16-bit image: the device is brute force, bit for bit") {
  check_on_device<triangle, sphere, clearance::recursive>(pick_raw{});
}

TEST_CASE("Inner spheres in spheres, stack, from a float image: the device is brute force, bit for bit") {
  check_on_device<inner_sphere, sphere, clearance::stack>(pick_metres{});
}

}  // namespace in_sphere_test
