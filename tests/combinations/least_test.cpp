// SPDX-License-Identifier: BSD-3-Clause
#include "combinations/cells.hpp"
#include "support/catch.hpp"

#include <clearance/questions/certain_distance.hpp>
#include <clearance/questions/min_distance.hpp>

namespace least_test {

using namespace combinations;

TEST_CASE("min_distance: each cell is asked, and says what is composed by hand") {
  check_cells("min_distance", clearance::min_distance{});
}
TEST_CASE("min_distance_per_part: each cell is asked, and says what is composed by hand") {
  check_cells("min_distance_per_part", clearance::min_distance_per_part{});
}
TEST_CASE("certain_distance: each cell is asked, and says what is composed by hand") {
  check_cells("certain_distance", clearance::certain_distance{{{0.01, 0.02}, {0, 0.01}, {0.02, 0}}});
}

}  // namespace least_test
