// SPDX-License-Identifier: BSD-3-Clause
#include "combinations/cells.hpp"
#include "support/catch.hpp"

#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances_per_part.hpp>

namespace combinations {

TEST_CASE("in_collisions: each cell is asked, and says what is composed by hand") {
  check_cells("in_collisions", clearance::in_collisions{{0.02}});
}
TEST_CASE("min_distances: each cell is asked, and says what is composed by hand") {
  check_cells("min_distances", clearance::min_distances{.d_max = 0.3, .radii = {0.02}});
}
TEST_CASE("min_distances_per_part: each cell is asked, and says what is composed by hand") {
  check_cells("min_distances_per_part", clearance::min_distances_per_part{.d_max = 0.3});
}

}  // namespace combinations
