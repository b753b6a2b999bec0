// SPDX-License-Identifier: BSD-3-Clause
#include "support/product.hpp"

#include <clearance/volume/aabb.hpp>

namespace triangles_in_aabb_test {

TEST_CASE("Triangles in axis-aligned boxes: every width, fit, traversal and point source is brute force, bit for bit") {
  testing::check_product<clearance::aabb, clearance::triangle>();
}

}  // namespace triangles_in_aabb_test
