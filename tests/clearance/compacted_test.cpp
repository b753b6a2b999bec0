// SPDX-License-Identifier: BSD-3-Clause
// A compacted cloud has the valid points of the cloud, in their order.
#include "support/catch.hpp"
#include "support/compacts.hpp"

#include <clearance/compacted.hpp>

namespace compacted_test {

using namespace testing;

TEST_CASE("What is left of a cloud are its valid points, in their order") { check_compacted(clearance::host{}); }

TEST_CASE("A cloud of more points than a call numbers is refused") {
  const clearance::point_span endless(nullptr, std::size_t(1) << 31);
  CHECK_THROWS_WITH(clearance::compacted_async(clearance::host{}, endless, nullptr, nullptr, nullptr),
                    "clearance: 2147483648 points are too many for one call; it takes 2^31 - 1");
}

}  // namespace compacted_test
