// SPDX-License-Identifier: BSD-3-Clause
// Every public struct whose members have a rule, with each of them wrong: what uses it refuses it by a sentence.
#include "doors/refusals.hpp"
#include "solid/shapes.hpp"

#include <clearance/make_model.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/near_maps.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/robot/joint_chain.hpp>
#include <clearance/separation.hpp>
#include <clearance/solid/mesh_solid.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace members_test {

using namespace testing;
using namespace clearance;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
const auto here = Eigen::Isometry3d::Identity();
const std::vector<inner_sphere> one{{{0, 0, 0}, 0.5f}}, many(20, one[0]);
const std::vector<vec3> points{{2, 0, 0}};

triangle_mesh two_boxes() {
  auto mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const auto other = shapes::box({3, 0, 0}, {4, 1, 1});
  const auto first = std::uint32_t(mesh.vertices.size());
  mesh.shapes = {0, std::uint32_t(mesh.triangles.size())};
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (auto t : other.triangles) {
    for (auto& v : t) v += first;
    mesh.triangles.push_back(t);
  }
  return mesh;
}

struct chain_parts {
  std::vector<chain_link> links = std::vector<chain_link>(2);
  std::vector<std::uint32_t> parts{0, 1};
  std::vector<joint_value> values{{"turn", {-1, 1}}, {"slide", {}}};
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();

  chain_parts() {
    links[0].value = 0, links[0].factor = 1;
    links[1].value = 1, links[1].factor = 1, links[1].parent = 0, links[1].slides = true;
  }
};

}  // namespace

TEST_CASE("a mesh whose members contradict one another is refused where it is used") {
  refused_doors r;
  const auto mesh = two_boxes();
  const auto used = [&](const char* what, const auto& spoil) {
    r.check(what, mesh, [](const auto& m) { close_mesh(m); }, spoil);
    r.check(what, mesh, [](const auto& m) { mesh_solid{m}; }, spoil);
  };
  used("shapes that begin later", [](auto& m) { m.shapes = {12}; });
  used("shapes beyond all triangles", [](auto& m) { m.shapes = {0, 100000}; });
  used("shapes that fall", [](auto& m) { m.shapes = {0, 12, 6}; });
  used("a corner that is none", [](auto& m) { m.triangles[5][1] = 16; });
  used("a vertex that is no number", [](auto& m) { m.vertices[3].y() = nan; });
  used("an infinite vertex", [](auto& m) { m.vertices[3].y() = inf; });
  used("no triangle", [](auto& m) { m.triangles.clear(), m.shapes.clear(); });

  const auto closed = close_mesh(mesh);
  const auto made = [&](const char* what, const auto& spoil) {
    r.check(what, closed, [](const auto& m) { make_part<aabb>(m); }, spoil);
    r.check(what, closed, [](const auto& m) { mesh_solid{m}; }, spoil);
  };
  made("fewer counts", [](auto& m) { m.counts.pop_back(); });
  made("fewer bodies", [](auto& m) { m.body.pop_back(); });
  made("more loaded", [](auto& m) { m.loaded = 25; });
  made("a negative tolerance", [](auto& m) { m.tolerance = -1e-6; });
  made("a tolerance that is no number", [](auto& m) { m.tolerance = nan; });
  made("a corner that is none", [](auto& m) { m.surface.triangles[23][2] = 99; });
  made("enclosed cubes without a grid", [](auto& m) { m.enclosed.bits = {1, 2, 3}; });
  made("enclosed cubes without a size",
       [](auto& m) { m.enclosed.bits = {1}, m.enclosed.size[0] = 32, m.enclosed.size[1] = m.enclosed.size[2] = 1; });
  CHECK(r.checked() == 30);
}

TEST_CASE("primitives, trees and parts that contradict themselves are refused") {
  refused_doors r;
  const auto built = [](const auto& all) { build<aabb>(all); };
  const auto of_sphere = [&](const char* what, const auto& spoil) {
    r.check(what, one, built, [&](auto& all) { spoil(all[0]); });
  };
  of_sphere("a negative radius", [](auto& s) { s.radius = -0.1f; });
  of_sphere("a radius that is no number", [](auto& s) { s.radius = not_a_number; });
  of_sphere("an infinite radius", [](auto& s) { s.radius = infinity; });
  of_sphere("a centre that is no number", [](auto& s) { s.center.z = not_a_number; });
  const std::vector faces{triangle::from({0, 0, 0}, {1, 0, 0}, {0, 1, 0})};
  const auto of_triangle = [&](const char* what, const auto& spoil) {
    r.check(what, faces, built, [&](auto& all) { spoil(all[0]); });
  };
  of_triangle("no normal", [](auto& t) { t.unit_normal = {0, 0, 0}; });
  of_triangle("a turned normal", [](auto& t) { t.unit_normal = -t.unit_normal; });
  of_triangle("a corner that moved", [](auto& t) { t.b = {0, 0, 1}; });
  of_triangle("a corner that is no number", [](auto& t) { t.c.x = not_a_number; });
  const auto of_build = [&](const char* what, const auto& spoil) {
    r.check(what, build_options{}, [](const build_options& o) { build<aabb>(one, o); }, spoil);
  };
  of_build("a width", [](auto& o) { o.width = 3; });
  of_build("no leaf", [](auto& o) { o.leaf_size = 0; });

  const auto of_tree = [&](const char* what, const auto& spoil) {
    r.check(what, build<aabb>(many), [](const auto& t) { make_part(t); }, spoil);
  };
  of_tree("nothing", [](auto& t) { t.nodes.clear(), t.volumes.clear(); });
  of_tree("fewer volumes", [](auto& t) { t.volumes.pop_back(); });
  of_tree("fewer numbers", [](auto& t) { t.ids.pop_back(); });
  of_tree("fewer primitives", [](auto& t) { t.primitives.pop_back(), t.ids.pop_back(); });
  of_tree("fewer nodes", [](auto& t) { t.nodes.pop_back(), t.volumes.pop_back(); });
  of_tree("too little depth", [](auto& t) { t.depth = 0; });
  of_tree("too little width", [](auto& t) { t.width = 1; });
  of_tree("a ring", [](auto& t) { t.nodes[0].first = 0; });

  packing packed;
  packed.spheres = one;
  const auto of_packing = [&](const char* what, const auto& spoil) {
    r.check(what, packed, [](const packing& p) { make_part<sphere>(p, {.tolerance = 0.5}); }, spoil);
  };
  of_packing("a negative gap", [](auto& p) { p.gap = -0.1; });
  of_packing("a gap that is no number", [](auto& p) { p.gap = nan; });
  of_packing("a negative tolerance that the options cover", [](auto& p) { p.tolerance = -0.1; });
  auto thick = close_mesh(shapes::cube(1));
  thick.tolerance = 0.5;
  packed.tolerance = 0.5;
  const auto of_part = [&](const char* what, const auto& spoil) {
    r.check(what, part_options{}, [&](const part_options& o) { make_part<aabb>(thick, o); }, spoil);
    r.check(what, part_options{}, [&](const part_options& o) { make_part<sphere>(packed, o); }, spoil);
    r.check(what, part_options{}, [&](const part_options& o) { make_part<sphere>(one, o); }, spoil);
  };
  of_part("a negative tolerance that the body covers", [](auto& o) { o.tolerance = -0.1; });
  of_part("a tolerance that is no number", [](auto& o) { o.tolerance = nan; });

  const auto part = make_part<sphere>(one), other = make_part<sphere>(std::vector{inner_sphere{{1, 0, 0}, 0.2f}});
  const model robot{std::vector{part, part}};
  const auto of_fields = [&](const char* what, const auto& spoil) {
    r.check(
        what, with_fields(host{}, robot, {1 << 15}).model.fields(), [&](const auto& f) { model(robot).set_fields(f); },
        spoil);
  };
  const auto foreign = with_fields(host{}, model{std::vector{other}}, {1 << 15}).model.fields()[0];
  of_fields("another part's field", [&](auto& all) { all[1] = foreign; });
  const auto its_cells = [](const auto& its) { return with_cells(host{}, its, {1 << 20, 0.1}).model.cells(); };
  r.check(
      "another part's cells", its_cells(robot), [&](const auto& all) { model(robot).set_cells(all); },
      [&](auto& all) { all[1] = its_cells(model{std::vector{other}})[0]; });
  of_fields("a field of fewer cells", [](auto& all) { all[0].cells.pop_back(); });
}

TEST_CASE("a robot's view that was filled in wrongly is refused") {
  refused_doors r;
  const auto part = make_part<sphere>(many);
  const model robot{std::vector{part, part}};
  const std::vector other(2, part_facts{{0, 0, 0}, 0.1f, 0, 0});
  const auto of = [&](const char* what, const auto& spoil) {
    const auto ask_it = [&](const auto& view) { ask(host{}, view, std::vector(2, here), points, min_distance{}); };
    r.check(what, robot.view(), ask_it, spoil);
    r.check(what, robot.view(), [](const auto& view) { query(host{}, view, min_distance{}); }, spoil);
  };
  of("no parts", [](auto& v) { v.parts = nullptr; });
  of("too little depth", [](auto& v) { v.depth = 0; });
  of("too little width", [](auto& v) { v.width = 1; });
  of("other facts", [&](auto& v) { v.facts = other; });
}

TEST_CASE("a joint chain that makes no sense is refused") {
  refused_doors r;
  const auto of = [&](const char* what, const auto& spoil) {
    r.check(
        what, chain_parts(), [](const chain_parts& g) { joint_chain<host>(g.links, g.parts, g.values, g.base); },
        spoil);
  };
  for (const double bad : {nan, inf, -inf}) {
    of("a factor", [&](chain_parts& g) { g.links[0].factor = bad; });
    of("an offset", [&](chain_parts& g) { g.links[1].offset = bad; });
    of("an axis", [&](chain_parts& g) { g.links[1].axis.y = bad; });
    of("an origin", [&](chain_parts& g) { g.links[0].origin.m[1][3] = bad; });
    of("a base", [&](chain_parts& g) { g.base(0, 3) = bad; });
  }
  of("a long axis", [](chain_parts& g) { g.links[0].axis = {1, 1, 0}; });
  of("a value that is none", [](chain_parts& g) { g.links[0].value = 2; });
  of("a parent that is none", [](chain_parts& g) { g.links[1].parent = 7; });
  of("a ring", [](chain_parts& g) { g.links[0].parent = 1; });
  of("a part that is none", [](chain_parts& g) { g.parts[1] = 2; });
  of("a range that falls", [](chain_parts& g) { g.values[0].range = {1, -1}; });
  of("a lower end", [](chain_parts& g) { g.values[0].range.lower = nan; });
  of("an upper end", [](chain_parts& g) { g.values[1].range.upper = nan; });
  of("nothing that moves", [](chain_parts& g) { g.values.clear(), g.links.clear(), g.parts.clear(); });
}

TEST_CASE(
    "options of motions, packings, minima and separations are refused where they are no lengths, times or counts") {
  refused_doors r;
  const auto robot = make_part<sphere>(one);
  const straight_motion way(std::vector{here}, std::vector{here});
  const auto of_motion = [&](const char* what, const auto& spoil) {
    r.check(
        what, motion_clearance_options{}, [&](const auto& o) { motion_clearance(host{}, robot, way, points, o); },
        spoil);
  };
  for (const double bad : {nan, -1.0}) {
    of_motion("tolerance", [&](auto& o) { o.tolerance = bad; });
    of_motion("margin", [&](auto& o) { o.margin = bad; });
    of_motion("a radius", [&](auto& o) { o.radii = {bad}; });
  }
  of_motion("an infinite margin", [](auto& o) { o.margin = inf; });
  of_motion("radii of other parts", [](auto& o) { o.radii = {0.1, 0.1}; });
  of_motion("no queries", [](auto& o) { o.most_queries = 0; });
  const auto stands = [](double) { return std::vector{here}; };
  const auto of_speeds = [&](const char* what, const auto& spoil) {
    r.check(
        what, std::vector<double>{0.5},
        [&](const auto& s) { motion_clearance(host{}, robot, timed_motion{stands, s}, points); }, spoil);
  };
  of_speeds("a speed that is no number", [](auto& s) { s[0] = nan; });
  of_speeds("a negative speed", [](auto& s) { s[0] = -1; });
  of_speeds("a speed too many", [](auto& s) { s.push_back(0); });

  const mesh_solid cube(shapes::cube(1));
  const auto of_packing = [&](const char* what, const auto& spoil) {
    r.check(what, pack_options{.count = 2}, [&](const auto& o) { pack(cube, o); }, spoil);
  };
  for (const double bad : {nan, -1.0}) {
    of_packing("smallest_radius", [&](auto& o) { o.smallest_radius = bad; });
    of_packing("gap_target", [&](auto& o) { o.gap_target = bad; });
    of_packing("seconds", [&](auto& o) { o.seconds = bad; });
    of_packing("gap_per_radius", [&](auto& o) { o.gap_per_radius = bad; });
    of_packing("gap_tolerance", [&](auto& o) { o.gap_tolerance = bad; });
  }

  const std::vector<part_minimum> minima{{1.0f, 0, 0, 0}};
  for (const double bad : {nan, inf, 0.0, -1.0})
    r.check("a temperature", 1.0, [&](double t) { smooth_minimum_of(minima, t); }, [&](double& t) { t = bad; });
  for (const real bad : {not_a_number, -infinity})
    r.check("a minimum", minima, [](const auto& m) { smooth_minimum_of(m, 1); }, [&](auto& m) { m[0].distance = bad; });
  const separation_terms terms{1, 1, 1, 1, 1, 1, 1, 1};
  for (double separation_terms::* const which :
       {&separation_terms::human_speed, &separation_terms::robot_speed, &separation_terms::reaction_time,
        &separation_terms::stopping_time, &separation_terms::stopping_distance, &separation_terms::intrusion,
        &separation_terms::human_uncertainty, &separation_terms::robot_uncertainty})
    for (const double bad : {nan, inf, -1.0})
      r.check("a term", terms, [](const auto& t) { protective_separation(t); }, [&](auto& t) { t.*which = bad; });
}

}  // namespace members_test
