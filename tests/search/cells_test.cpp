// SPDX-License-Identifier: BSD-3-Clause
// Cells on the host, and what can have none.
#include "search/celled.hpp"

namespace cells_test {

using namespace testing;
using clearance::host, clearance::with_cells;

TEST_CASE("Cells list every primitive that can be nearest: all scenes, one part of each") {
  cells_law<host> law{host{}};
  dice d(441);
  std::size_t number = 0;
  const auto check = [&](const auto& all, auto volume) {
    for (const auto& s : all) {
      auto one = s;
      one.parts = {s.parts[number++ % s.parts.size()]};
      const auto bare = make_model<decltype(volume)>(one, {}, clearance::wrapped{});
      const double reach = s.size * (number % 3 == 0 ? 0 : number % 3 == 1 ? 0.5 : 4);
      law.check(law.equip(bare, s.name, {1 << 21, reach}, s.name != "coincident"), d, s.name);
    }
  };
  check(scenes<inner_sphere>(), clearance::sphere{});
  check(scenes<triangle>(), clearance::aabb{});
}

TEST_CASE("Cells of primitives that are hard to tell apart") {
  cells_law<host> law{host{}};
  dice d(442);
  const auto check = [&](const auto& all, auto volume) {
    for (const auto& part : all) {
      law.check(law.equip(model_of<decltype(volume)>(part), part.name, part.options), d, part.name, 4000);
    }
  };
  check(odd_parts<inner_sphere>(), clearance::sphere{});
  check(odd_parts<triangle>(), clearance::obb{});
  check(std::vector{too_many<inner_sphere>()}, clearance::sphere{});
  check(std::vector{too_many<triangle>()}, clearance::obb{});
}

TEST_CASE("Where cells say a side of a solid, it is right") {
  for (const double tolerance : {0.0, 0.3, 2.0}) {
    cells_law<host> law{host{}};
    dice d(443);
    law.check(law.equip(solid_robot(tolerance), "solids", {1 << 22, 3}), d, "solids", 4000);
  }
}

}  // namespace cells_test
