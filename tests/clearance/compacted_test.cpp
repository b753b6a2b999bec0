// SPDX-License-Identifier: BSD-3-Clause
// A compacted cloud has the valid points of the cloud, in their order.
#include "support/catch.hpp"
#include "support/compacts.hpp"

#include <clearance/compacted.hpp>

namespace compacted_test {

using namespace testing;

TEST_CASE("What is left of a cloud are its valid points, in their order") {
  verdict v;
  for_each_compacted([&](const auto& source, const auto& points, const auto& numbers, const std::string& what) {
    const auto found = clearance::compacted(clearance::host{}, source);
    v.require(found.numbers == numbers, what, ": ", found.numbers.size(), " are left, and not ", numbers.size());
    v.require(found.points.size() == points.size() &&
                  std::ranges::equal(found.points, points, [](vec3 a, vec3 b) { return same_bytes(a, b); }),
              what, ": some point differs");
  });
}

TEST_CASE("A cloud of more points than a call numbers is refused") {
  const clearance::point_span endless(nullptr, std::size_t(1) << 31);
  CHECK_THROWS_WITH(clearance::compacted_async(clearance::host{}, endless, nullptr, nullptr, nullptr),
                    "clearance: 2147483648 points are too many for one call; it takes 2^31 - 1");
}

}  // namespace compacted_test
