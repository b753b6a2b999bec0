// SPDX-License-Identifier: BSD-3-Clause
#include "support/product.hpp"

#include <clearance/volume/sphere.hpp>

namespace triangles_in_sphere_test {

TEST_CASE("Triangles in spheres: every width, fit, traversal and point source is brute force, bit for bit") {
  testing::check_product<clearance::sphere, clearance::triangle>();
}

}  // namespace triangles_in_sphere_test
