// SPDX-License-Identifier: BSD-3-Clause
#include "combinations/cells.hpp"
#include "support/catch.hpp"

#include <clearance/questions/distances.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/self_filter.hpp>

namespace each_point_test {

using namespace combinations;

TEST_CASE("distances: each cell is asked, and says what is composed by hand") {
  check_cells("distances", clearance::distances{.d_max = 0.6, .which = true});
}
TEST_CASE("distances_per_part: each cell is asked, and says what is composed by hand") {
  check_cells("distances_per_part", clearance::distances_per_part{.d_max = 0.5});
}
TEST_CASE("self_filter: each cell is asked, and says what is composed by hand") {
  check_cells("self_filter", clearance::self_filter{.padding = {0.05}});
}
TEST_CASE("min_distance_supported: each cell is asked, and says what is composed by hand") {
  check_cells("min_distance_supported", clearance::min_distance_supported{.min_points = 2, .radius = 0.1});
}

}  // namespace each_point_test
