// SPDX-License-Identifier: BSD-3-Clause
#include "combinations/cells.hpp"
#include "support/catch.hpp"

#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/within.hpp>

namespace listed_test {

using namespace combinations;

TEST_CASE("within: each cell is asked, and says what is composed by hand") {
  check_cells("within", clearance::within{{0.1}});
}
TEST_CASE("nearest_k: each cell is asked, and says what is composed by hand") {
  check_cells("nearest_k", clearance::nearest_k{.k = 7});
}

}  // namespace listed_test
