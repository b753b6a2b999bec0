// SPDX-License-Identifier: BSD-3-Clause
#include "support/catch.hpp"

#include <clearance/robot/part_pairs.hpp>

namespace part_pairs_test {

using Catch::Matchers::Contains;
using clearance::none, clearance::part_pairs;

TEST_CASE("All pairs can meet but those that are removed, by name, as neighbours, or as a list") {
  part_pairs pairs(5);
  CHECK(pairs.size() == 10);
  pairs.remove_neighbours(std::vector<std::uint32_t>{none, 0, 1, 2, 2});
  CHECK(pairs.size() == 6);
  pairs.remove(std::vector<std::pair<std::uint32_t, std::uint32_t>>{{4, 3}, {0, 2}});
  CHECK(pairs.size() == 4);
  CHECK((!pairs.has(3, 4) && !pairs.has(4, 3) && pairs.has(4, 0) && !pairs.has(2, 0)));
  CHECK(pairs.above(0) == std::vector<std::uint32_t>{3, 4});
  CHECK(pairs.above(1) == std::vector<std::uint32_t>{3, 4});
  CHECK((pairs.above(2).empty() && pairs.above(4).empty()));
  CHECK(pairs.set(2, 0, true).above(0) == std::vector<std::uint32_t>{2, 3, 4});
}

TEST_CASE("Pairs that name no parts of the robot are refused") {
  part_pairs pairs(3);
  CHECK_THROWS_WITH(pairs.remove(1, 3), Contains("parts 1 and 3 are no pair of a robot of 3 parts"));
  CHECK_THROWS_WITH(pairs.has(2, 2), Contains("parts 2 and 2 are no pair"));
  CHECK_THROWS_WITH(pairs.remove_neighbours(std::vector<std::uint32_t>{none, 0}), Contains("3 parts, but 2 parents"));
  CHECK(pairs.size() == 3);
}

}  // namespace part_pairs_test
