// SPDX-License-Identifier: BSD-3-Clause
#include "support/product.hpp"

#include <clearance/volume/obb.hpp>

namespace triangles_in_obb_test {

TEST_CASE("Triangles in oriented boxes: every width, fit, traversal and point source is brute force, bit for bit") {
  testing::check_product<clearance::obb, clearance::triangle>();
}

}  // namespace triangles_in_obb_test
