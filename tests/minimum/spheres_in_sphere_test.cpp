// SPDX-License-Identifier: BSD-3-Clause
#include "support/product.hpp"

#include <clearance/volume/sphere.hpp>

namespace spheres_in_sphere_test {

TEST_CASE("Inner spheres in spheres: every width, fit, traversal and point source is brute force, bit for bit") {
  testing::check_product<clearance::sphere, clearance::inner_sphere>();
}

}  // namespace spheres_in_sphere_test
