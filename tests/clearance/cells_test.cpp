// SPDX-License-Identifier: BSD-3-Clause
// Cells on the host, and what can have none.
#include "clearance/celled.hpp"
#include "support/poor_host.hpp"

#include <clearance/robot/attached.hpp>
#include <clearance/robot/widened.hpp>

namespace cells_test {

using namespace testing;
using clearance::host, clearance::with_cells;

namespace {

template <class V, class P>
void check_scenes(cells_law<host>& law) {
  dice d(441);
  std::size_t number = 0;
  std::string before;
  for (scene<P> s : scenes<P>()) {
    if (s.name == std::exchange(before, s.name)) continue;  // only its points are others
    s.parts = {s.parts[number++ % s.parts.size()]};
    const double reach = s.size * (number % 3 == 0 ? 0 : number % 3 == 1 ? 0.5 : 4);
    const auto bare = make_model<V>(s, {}, clearance::wrapped{});
    law.check(law.equip(bare, s.name, {1 << 21, reach}, s.name != "coincident"), d, s.name);
  }
}

template <class V, class P>
void check_odd_parts(cells_law<host>& law) {
  dice d(442);
  auto all = odd_parts<P>();
  all.push_back(equal_in_a_box<P>(100));
  all.push_back(equal_in_a_box<P>(300));
  for (const auto& part : all) law.check(law.equip(odd_model<V>(part), part.name, part.options), d, part.name, 4000);
}

auto fifty_spheres() {
  dice d(444);
  return clearance::make_part(clearance::build<clearance::sphere>(random_spheres(d, 50, 0.4)));
}

}  // namespace

TEST_CASE("A part's cells list every primitive that can be nearest, in all scenes") {
  cells_law<host> law{host{}};
  check_scenes<clearance::sphere, inner_sphere>(law);
  check_scenes<clearance::aabb, triangle>(law);
  CHECK((law.leaves[1] > 20000 && law.beyond > 5000 && law.ties > 2000 && law.with == 22 && law.without == 2));
  CHECK((law.leaves[0] == 0 && law.leaves[2] == 0));
  CHECK(law.listed < 4 * law.leaves[1]);  // of 20 to 90 primitives
}

TEST_CASE("Cells of primitives that are hard to tell apart") {
  cells_law<host> law{host{}};
  check_odd_parts<clearance::sphere, inner_sphere>(law);
  check_odd_parts<clearance::obb, triangle>(law);
  CHECK((law.leaves[0] > 500 && law.leaves[1] > 50000 && law.ties > 10000 && law.long_lists > 500));
}

TEST_CASE("Cells of a primitive of somebody else's") {
  cells_law<host> law{host{}};
  dice d(445);
  law.check(law.equip(clearance::model{std::vector{clearance::make_part(clearance::build<clearance::obb>(rods(d)))}},
                      "rods", {1 << 22, 2}),
            d, "rods", 6000);
  CHECK((law.leaves[1] > 1000 && law.ties > 100));
}

TEST_CASE("Where cells say a side of a solid, it is right") {
  for (const double tolerance : {0.0, 0.3, 2.0}) {
    cells_law<host> law{host{}};
    dice d(443);
    law.check(law.equip(solid_robot(1, tolerance), "solids", {1 << 22, 1 + tolerance}), d, "solids", 3000);
    CHECK((law.outside > 500 && law.outside < law.leaves[1]));
    CHECK((law.leaves[2] > 20) == (tolerance < 1));
  }
}

TEST_CASE("Cells take the memory that they may, or there are none") {
  dice d(446);
  const clearance::model robot = odd_model<clearance::sphere>(equal_in_a_box<inner_sphere>(100));
  const auto size_of = [&](std::size_t bytes) {
    cells_law<host> law{host{}};
    const auto made = law.equip(robot, std::to_string(bytes) + " bytes", {bytes, 0});
    law.check(made, d, std::to_string(bytes) + " bytes", 3000);
    CHECK(law.leaves[0] == 0);
    return made.cells()[0].bytes();
  };
  const std::size_t all = size_of(1 << 24), some = size_of(all * 3 / 4);
  CHECK((all < 1 << 24 && some <= all * 3 / 4));
  const auto none = with_cells(host{}, robot, {1000, 0});
  CHECK(none.without[0] == "1000 bytes are too few for cells of its 112 primitives");
  CHECK((cells_of(none.model, 0).empty() && none.model.view().cells == nullptr));
  CHECK(with_cells(host{}, robot, {(std::size_t(1) << 34) + 1, 0}).without[0] ==
        "17179869185 bytes are too many for cells; they take at most 17179869184");
  const auto poorly = with_cells(poor{}, robot, {1 << 24, 0});
  CHECK(poorly.without[0] == "there is not enough memory to make its cells");
  CHECK((cells_of(poorly.model, 0).empty() && poorly.model.view().cells == nullptr));
}

TEST_CASE("Cells reach no less than 0, and not beyond all numbers") {
  const clearance::model robot{std::vector{fifty_spheres()}};
  const auto refused = [&](double reach, const std::string& said) {
    CHECK_THROWS_AS(with_cells(host{}, robot, {1 << 20, reach}), std::invalid_argument);
    CHECK_THROWS_WITH(with_cells(host{}, robot, {1 << 20, reach}),
                      "clearance::with_cells: cells reach " + said + " m, which must be from 0 to 1,000,000");
  };
  refused(-1e-3, "-0.001000");
  refused(std::numeric_limits<double>::quiet_NaN(), "nan");
  refused(1e7, "10000000.000000");
  refused(std::numeric_limits<double>::infinity(), "inf");
  for (const double reach : {0.0, 0.7}) {
    const auto made = with_cells(host{}, robot, {1 << 21, reach}).model;
    REQUIRE(!cells_of(made, 0).empty());
    const auto cells = made.cells()[0].view();
    const auto& facts = robot.parts()[0].facts;
    const auto listed = [&](real share) {
      const real away = share * (facts.radius + real(reach));
      const vec3 ways[] = {{away, 0, 0}, {-away, 0, 0}, {0, away, 0}, {0, -away, 0}, {0, 0, away}, {0, 0, -away}};
      return std::ranges::count_if(ways, [&](vec3 way) { return cells(facts.center + way).node.count != 0; });
    };
    CHECK((listed(0) == 6 && listed(0.9999f) == 6 && listed(1.01f) == 0));
  }
}

TEST_CASE("A part without a size has no cells") {
  const auto part = fifty_spheres();
  auto endless = part, far = part;
  endless.facts.radius = infinity, far.facts.center.x = 1e7f;
  const auto point = clearance::make_part(clearance::build<clearance::sphere>(std::vector{inner_sphere{{1, 2, 3}, 0}}));
  for (const auto& other : {endless, far, point}) {
    const auto made = with_cells(host{}, clearance::model{std::vector{part, other}}, {1 << 21, 0.5});
    CHECK(made.without[0].empty());
    CHECK(made.without[1] == "a part without a finite size has no cells");
    CHECK((!cells_of(made.model, 0).empty() && cells_of(made.model, 1).empty()));
    CHECK(made.model.view().cells[1].nodes == nullptr);
  }
}

TEST_CASE("Copies of a robot keep their cells; so do parts that may be elsewhere, and what is attached") {
  const auto part = fifty_spheres();
  const clearance::model bare{std::vector{part, part}};
  auto robot = with_cells(host{}, bare, {1 << 21, 0.5}).model;
  const auto nodes = [](const auto& view, std::size_t k) { return view.cells[k].nodes; };
  const auto view = robot.view();
  REQUIRE((nodes(view, 0) != nullptr && nodes(view, 0) != nodes(view, 1)));

  cells_law<host> law{host{}};
  dice d(447);
  auto copy = robot;
  CHECK((nodes(copy.view(), 0) != nullptr && nodes(copy.view(), 0) != nodes(view, 0)));
  const auto moved = std::move(copy);
  law.check(moved, d, "moved", 200);
  copy = moved;
  CHECK((nodes(copy.view(), 0) != nodes(moved.view(), 0)));
  law.check(copy, d, "assigned", 200);
  const auto copied = robot.on(host{});
  CHECK(nodes(copied.view(), 1) != nullptr);

  const auto both = clearance::attach(host{}, robot, robot);
  CHECK((nodes(both.view(), 1) == nodes(view, 1) && nodes(both.view(), 2) == nodes(view, 0)));
  clearance::widened_model widened(host{}, view);
  const std::vector radii{0.1};
  CHECK((nodes(widened(radii), 1) == nodes(view, 1) && nodes(widened({}), 1) == nodes(view, 1)));
  const auto cloud = d.points(300, 1);
  const std::vector poses{d.pose(0.3), d.pose(0.3)};
  const clearance::distances every{.which = true};
  CHECK(same_answer(ask(host{}, robot, poses, clearance::point_span(cloud), every),
                    ask(host{}, bare, poses, clearance::point_span(cloud), every)));
}

}  // namespace cells_test
