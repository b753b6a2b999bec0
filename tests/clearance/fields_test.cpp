// SPDX-License-Identifier: BSD-3-Clause
// Fields on the host, and what can have none.
#include "clearance/fielded.hpp"
#include "support/poor_host.hpp"

#include "support/linked_tree.hpp"

#include <clearance/robot/attached.hpp>

namespace fields_test {

using namespace testing;
using clearance::field_options, clearance::host, clearance::with_fields;

TEST_CASE("A field's bounds contain the distance, and change no answer") { check_fields(host{}); }

TEST_CASE("Fields of robots of extreme numbers are right, or there are none") {
  fields_law<host> law{host{}};
  dice d(432);
  std::size_t with = 0, without = 0;
  for (const auto& s : edge_scenes()) {
    const auto bare = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto made = with_fields(host{}, bare, {1 << 15});
    ++(made.model.view().fields != nullptr ? with : without);
    law.check(made.model, d, s.name);
    require_no_change(host{}, bare, made.model, configurations_of(s, d, 4),
                      clearance::placed{clearance::point_span(s.points), s.cloud_pose}, s.size, law.v, s.name);
  }
  CHECK((with > 0 && without > 0));
}

TEST_CASE("A part that can have no field says why, and then no part has one") {
  dice d(433);
  const auto spheres = random_spheres(d, 50, 0.4);
  const auto part = clearance::make_part(clearance::build<clearance::sphere>(spheres), 0, 0);
  auto endless = part;
  endless.facts.radius = infinity;
  const auto made = with_fields(host{}, clearance::model{std::vector{part, endless}});
  CHECK(made.without[0].empty());
  CHECK(made.without[1] == "a part without a finite size has no field");
  CHECK(made.model.view().fields == nullptr);
  CHECK(with_fields(host{}, clearance::model{std::vector{part}}, {1000}).without[0] ==
        "1000 bytes are too few for a field; it needs 20480");
  const auto whole = with_fields(host{}, clearance::model{std::vector{part}}).model;
  CHECK(whole.view().fields != nullptr);
  const auto copied = whole.on(host{});
  CHECK(copied.view().fields != nullptr);
  CHECK(whole.view().part(0).fields == whole.view().fields);
  const clearance::model alone{std::vector{part}};
  const auto both = clearance::attach(host{}, whole, alone);
  CHECK(both.view().fields == nullptr);
  const auto twice = clearance::attach(host{}, whole, whole);
  CHECK((twice.view().fields != nullptr && twice.view().fields[1].cells == whole.view().fields[0].cells));
}

TEST_CASE("Without enough memory for a field there is a sentence, and the answer of the robot without it") {
  dice d(437);
  const clearance::model bare{
      std::vector{clearance::make_part(clearance::build<clearance::sphere>(random_spheres(d, 50, 0.4)), 0, 0)}};
  const auto made = with_fields(poor{}, bare);
  CHECK(made.without[0] == "there is not enough memory to sample its field");
  CHECK(made.model.view().fields == nullptr);
  const auto much = with_fields(host{}, bare, {~std::size_t(0)});
  CHECK(much.without[0] == "18446744073709551615 bytes are too many for a field; it takes at most 17179869184");
  CHECK(much.model.view().fields == nullptr);
  configurations poses;
  for (int c = 0; c < 20; ++c) poses.push_back(d.pose(1));
  const auto cloud = d.points(300, 1.5);
  const auto of = [&](const auto& robot) {
    return ask(host{}, robot, poses, clearance::point_span(cloud), clearance::min_distances{});
  };
  CHECK(same_answer(of(made.model), of(bare)));
  CHECK(same_answer(of(much.model), of(bare)));
}

TEST_CASE("A copy of a robot reads its own parts and fields") {
  dice d(436);
  const auto original =
      with_fields(host{}, clearance::model{std::vector{clearance::make_part(
                              clearance::build<clearance::sphere>(random_spheres(d, 50, 0.4)), 0, 0)}});
  auto copy = original.model;
  const auto own = [](const auto& model) {
    const auto tree = model.view().parts[0].tree;
    const auto* at = &tree.volume(tree.root());
    const auto& its = model.parts()[0].tree.volumes;
    return at >= its.data() && at < its.data() + its.size();
  };
  CHECK((own(original.model) && own(copy)));
  CHECK(copy.view().fields[0].cells != original.model.view().fields[0].cells);
  const auto moved = std::move(copy);
  CHECK(own(moved));
  copy = moved;
  CHECK((own(copy) && own(moved) && copy.view().fields != moved.view().fields));
}

TEST_CASE("An open mesh has a field, and one of few bytes is wide") {
  fields_law<host> law{host{}};
  dice d(435);
  auto open = shapes::cube(1);
  open.triangles.resize(1);
  const auto mesh = clearance::close_mesh(open, {.cap = false});
  CHECK_FALSE(mesh.closed);
  const auto bare = clearance::make_model<clearance::obb>(std::vector(2, mesh));
  for (const std::size_t bytes : {20480u, 1u << 18}) {
    const auto fielded = law.with(bare, "an open mesh", bytes);
    law.check(fielded, d, "an open mesh");
    configurations poses;
    for (int c = 0; c < 40; ++c) poses.push_back(d.pose(1));
    const auto points = d.points(500, 2);
    require_no_change(host{}, bare, fielded, poses, clearance::point_span(points), 1, law.v, "an open mesh");
  }
  CHECK(law.sides[int(clearance::field_side::inside)] == 0);
}

TEST_CASE("A tree of somebody else's has a field around its ball") {
  dice d(434);
  const auto spheres = random_spheres(d, 100, 0.4);
  const auto around = clearance::enclosing_ball(std::span<const inner_sphere>(spheres));
  const linked_tree<clearance::obb, inner_sphere> tree(spheres, false);
  const clearance::model bare{
      std::vector{clearance::part{tree.view(), clearance::no_interior{}, {around.center, around.radius, 0.001f, 0}}}};
  fields_law<host> law{host{}};
  const auto fielded = law.with(bare, "a linked tree");
  law.check(fielded, d, "a linked tree");
  configurations poses;
  for (int c = 0; c < 20; ++c) poses.push_back(d.pose(1.5));
  const auto points = d.points(2000, 1);
  require_no_change(host{}, bare, fielded, poses, clearance::point_span(points), 1, law.v, "a linked tree");
}

}  // namespace fields_test
