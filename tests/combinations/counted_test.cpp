// SPDX-License-Identifier: BSD-3-Clause
#include "combinations/cells.hpp"
#include "support/catch.hpp"

#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/zones.hpp>

namespace counted_test {

using namespace combinations;

TEST_CASE("in_collision: each cell is asked, and says what is composed by hand") {
  check_cells("in_collision", clearance::in_collision{{0.05}, {0.03}});
}
TEST_CASE("zones: each cell is asked, and says what is composed by hand") {
  check_cells("zones", clearance::zones{.thresholds = {0.05, 0.2, 0.6}, .radii = {0.02}});
}

}  // namespace counted_test
