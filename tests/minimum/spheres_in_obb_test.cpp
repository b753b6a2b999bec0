// SPDX-License-Identifier: BSD-3-Clause
#include "support/product.hpp"

#include <clearance/volume/obb.hpp>

namespace spheres_in_obb_test {

TEST_CASE("Inner spheres in oriented boxes: every width, fit, traversal and point source is brute force, bit for bit") {
  testing::check_product<clearance::obb, clearance::inner_sphere>();
}

}  // namespace spheres_in_obb_test
