// SPDX-License-Identifier: BSD-3-Clause
// The structs of robots, scenes and bodies, with each member wrong.
#include "doors/refusals.hpp"
#include "io/glb_writer.hpp"
#include "io/robot_link.hpp"
#include "solid/shapes.hpp"

#include <clearance/io/joint_motion.hpp>
#include <clearance/io/part_radii.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/io/robot_bodies.hpp>
#include <clearance/io/scene.hpp>

namespace files_test {

using namespace testing;
using namespace clearance::io;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("a scene whose arrays contradict one another is not drawn") {
  refused_doors r;
  scene right;
  right.bodies.push_back({"box", shapes::cube(1)});
  right.clouds.push_back({.name = "points", .points = {{0, 0, 0}, {1, 0, 0}}, .colours = {{1, 0, 0, 1}, {0, 1, 0, 1}}});
  const auto of = [&](const char* what, const auto& spoil) {
    r.check(what, right, [](const scene& s) { scene_bytes(s, "scene.glb"); }, spoil);
  };
  of("fewer colours", [](scene& s) { s.clouds[0].colours.pop_back(); });
  of("more colours", [](scene& s) { s.clouds[0].colours.push_back({0, 0, 1, 1}); });
  of("a corner that is none", [](scene& s) { s.bodies[0].mesh.triangles[3][1] = 8; });
  of("a vertex that is no number", [](scene& s) { s.bodies[0].mesh.vertices[3].x() = nan; });
  const auto drawn = faces_of(shapes::cube(1));
  const auto of_drawn = [&](const char* what, const auto& spoil) {
    const auto add = [](const drawn_mesh& m) {
      glb_writer("scene.glb").add("mesh", m, Eigen::Isometry3d::Identity(), {1, 1, 1, 1}, "");
    };
    r.check(what, drawn, add, spoil);
  };
  of_drawn("fewer normals", [](auto& m) { m.normals.pop_back(); });
  of_drawn("a corner too many", [](auto& m) { m.corners.push_back(0); });
  of_drawn("a corner that is none", [](auto& m) { m.corners[7] = 36; });
}

TEST_CASE("bodies, robots and joints that make no sense are refused") {
  refused_doors r;
  const auto mesh = shapes::cube(1);
  const body_source source{"box", &mesh};
  const auto of_body = [&](const char* what, const auto& spoil) {
    const auto make = [](const body_source& s) {
      body_options options;
      options.spheres = false;
      body_account account;
      try {
        make_bodies({s}, options, account);
      } catch (const std::runtime_error& e) {  // which names the link
        throw std::invalid_argument(std::string("clearance: ") + e.what());
      }
    };
    r.check(what, source, make, spoil);
  };
  of_body("no mesh", [](auto& s) { s.mesh = nullptr; });
  of_body("a negative tolerance", [](auto& s) { s.tolerance = -1; });
  of_body("a tolerance that is no number", [](auto& s) { s.tolerance = nan; });
  for (const double bad : {nan, -1e-4})
    r.check(
        "tessellation", robot_options{},
        [](const robot_options& o) {
          note_tally notes;
          robot_reader("robot.urdf", o, 1, notes);
        },
        [&](auto& o) { o.tessellation = bad; });

  joint turns;
  turns.name = "turn", turns.kind = joint_kind::revolute, turns.parent = "base", turns.child = "arm";
  const kinematic_tree tree({"base", "arm"}, {turns});
  const std::vector<std::size_t> links{1};
  const std::vector facts{clearance::part_facts{{0, 0, 0}, 1, 0, 0}};
  const std::vector<double> q{0};
  std::vector<double> one{0.1}, two{0.1, 0.1}, wrong{nan}, negative{-0.1}, endless{inf};
  const auto of = [&](const char* what, const auto& spoil) {
    r.check(
        what, joint_uncertainty{one, one, 0.1},
        [&](const joint_uncertainty& u) { part_radii(tree, links, facts, q, u); }, spoil);
  };
  of("two errors", [&](auto& u) { u.errors = two; });
  of("an error that is no number", [&](auto& u) { u.errors = wrong; });
  of("a negative error", [&](auto& u) { u.errors = negative; });
  of("an infinite speed", [&](auto& u) { u.speeds = endless; });
  of("two speeds", [&](auto& u) { u.speeds = two; });
  of("a negative delay", [&](auto& u) { u.delay = -1; });
  of("a delay that is no number", [&](auto& u) { u.delay = nan; });
  const std::vector poses(2, Eigen::Isometry3d::Identity());
  r.check(
      "a link that is none", links, [&](const auto& which) { joint_motion(tree, which, q, q); },
      [](auto& which) { which[0] = 2; });
}

}  // namespace files_test
