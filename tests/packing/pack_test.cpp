// SPDX-License-Identifier: BSD-3-Clause
#include "packing/laws.hpp"

#include <clearance/packing/pack.hpp>
#include <clearance/solid/implicit.hpp>

#include <filesystem>

using namespace packing_laws;

TEST_CASE("spheres lie inside, apart, in order, and the gap is certified") {
  using namespace shapes;
  const auto cube = box({0, 0, 0}, {1, 1, 1});
  const struct {
    triangle_mesh mesh;
    std::size_t count;
  } cases[] = {
      {cube, 300},
      {inverted(cube), 50},
      {globe({5, -3, 2}, 0.02), 200},
      {box({0, 0, 0}, {1, 1, 0.01}), 300},                                   // a thin plate
      {merged(cube, globe({1, 0.5, 0.5}, 0.6)), 200},                        // overlapping shells
      {merged(cube, inverted(globe({0.5, 0.5, 0.5}, 0.3))), 200},            // a cavity
      {merged(box({-1, -1, -1}, {2, 2, 2}), cube), 100},                     // nested shells of one orientation
      {merged(cube, box({3, 0, 0}, {4, 2, 1})), 100},                        // two pieces
      {box({0, 0, 0}, {1000, 800, 50}), 100},                                // millimetres
      {box({1000, 1000, 1000}, {1000.1, 1000.1, 1000.1}), 50},               // far from its origin
  };
  for (const auto& c : cases) {
    const packing p = pack(soup(c.mesh), {.count = c.count});
    CHECK(p.spheres.size() == c.count);
    CHECK(p.stopped_by == pack_stop::count);
    check_laws(c.mesh, p);
  }
}

TEST_CASE("the first sphere of a cube is its inscribed one, the next sit in its corners") {
  const packing p = pack(shapes::box({0, 0, 0}, {1, 1, 1}), {.count = 9, .gap_per_radius = std::numeric_limits<double>::infinity()});
  CHECK(p.spheres[0].radius == Approx(0.5).epsilon(1e-3));
  const double corner = 0.5 * (std::sqrt(3.0) - 1) / (std::sqrt(3.0) + 1);
  for (int i = 1; i < 9; ++i) CHECK(p.spheres[i].radius == Approx(corner).epsilon(1e-2));
}

TEST_CASE("the certified gap is close to a gap that is met") {
  for (const std::size_t count : {1, 20, 300}) {
    const auto mesh = shapes::merged(shapes::box({0, 0, 0}, {1, 2, 1}), shapes::globe({0.5, 2, 0.5}, 0.7));
    const packing p = pack(mesh, {.count = count});
    const double met = met_gap(mesh_solid(mesh), p);
    CHECK(p.gap >= met);
    CHECK(p.gap <= 1.03 * met);
  }
}

TEST_CASE("a packing depends on its seed, and not on the number of threads") {
  const auto mesh = shapes::merged(shapes::box({0, 0, 0}, {1, 0.7, 0.9}), shapes::globe({1, 0.5, 0.5}, 0.4));
  const packing one = pack(mesh, {.count = 400, .seed = 1, .threads = 1});
  CHECK(same(one, pack(mesh, {.count = 400, .seed = 1, .threads = 1})));
  CHECK(same(one, pack(mesh, {.count = 400, .seed = 1, .threads = 3})));
  const packing other = pack(mesh, {.count = 400, .seed = 2});
  CHECK_FALSE(same(one, other));
  CHECK(one.fill == Approx(other.fill).epsilon(0.03));
}

TEST_CASE("packing stops for each of its reasons") {
  const auto cube = shapes::box({0, 0, 0}, {1, 1, 1});
  packing p = pack(cube, {.count = 100000, .smallest_radius = 0.05});
  CHECK(p.stopped_by == pack_stop::smallest_radius);
  CHECK(p.spheres.size() > 9);
  CHECK(p.radius_min >= 0.05 - 1e-8);
  CHECK(p.room == 0.05);
  p = pack(cube, {.count = 100000, .gap_target = 0.1});
  CHECK(p.stopped_by == pack_stop::gap);
  CHECK(p.gap <= 0.1);
  int asked = 0;
  p = pack(cube, {.count = 100000, .cancelled = [&] { return ++asked > 20; }});
  CHECK(p.stopped_by == pack_stop::cancelled);
  CHECK(!p.spheres.empty());
  std::size_t last = 0;
  p = pack(cube, {.count = 10000000, .seconds = 0.2, .progress = [&](std::size_t done, std::size_t of) {
    CHECK(done >= last);
    CHECK(of == 10000000);
    last = done;
  }});
  CHECK(p.stopped_by == pack_stop::time);
  CHECK(last > 0);
  CHECK(!p.reason().empty());
  const packing none = pack(cube, {.count = 0});
  CHECK(none.spheres.empty());
  CHECK(std::isinf(none.gap));
}

TEST_CASE("spheres that may overlap leave a smaller gap") {
  const auto mesh = shapes::box({0, 0, 0}, {1, 0.5, 0.25});
  const packing apart = pack(mesh, {.count = 200}), overlapping = pack(mesh, {.count = 200, .allow_overlap = true});
  check_laws(mesh, overlapping, 1000, true);
  CHECK(overlapping.gap < apart.gap);
}

TEST_CASE("an implicit solid is packed by the same code") {
  const auto torus = [](const Vector3d& p) { return std::hypot(std::hypot(p.x(), p.y()) - 1, p.z()) - 0.25; };
  const implicit_solid s(torus, Eigen::AlignedBox3d(Vector3d(-1.25, -1.25, -0.25), Vector3d(1.25, 1.25, 0.25)));
  const packing p = pack(s, {.count = 200});
  CHECK(p.spheres.size() == 200);
  CHECK(p.radius_max == Approx(0.25).epsilon(1e-3));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1.5, 1.5);
  for (const inner_sphere& a : p.spheres) CHECK(torus({a.center.x, a.center.y, a.center.z}) <= -double(a.radius));
  int broken = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3d at(unit(random), unit(random), unit(random) / 4);
    const double exact = std::max(0.0, torus(at)), d = sphere_distance(p, at);
    broken += !(exact >= std::max(0.0, d - p.gap) && exact <= std::max(0.0, d));
  }
  CHECK(broken == 0);
}

TEST_CASE("a ball is full after one sphere, and packing says so") {
  const auto f = [](const Vector3d& p) { return p.norm() - 1; };
  const implicit_solid s(f, Eigen::AlignedBox3d(Vector3d(-1, -1, -1), Vector3d(1, 1, 1)));
  const packing p = pack(s, {.count = 5, .smallest_radius = 0.01});
  CHECK(p.spheres.size() == 1);
  CHECK(p.stopped_by == pack_stop::smallest_radius);
}

TEST_CASE("options and solids that make no sense are refused") {
  const auto cube = shapes::box({0, 0, 0}, {1, 1, 1});
  CHECK_THROWS_AS(pack(cube, {.smallest_radius = -1}), std::invalid_argument);
  CHECK_THROWS_AS(pack(cube, {.gap_target = std::nan("")}), std::invalid_argument);
  CHECK_THROWS_AS(pack(cube, {.seconds = -1}), std::invalid_argument);
  CHECK_THROWS_AS(pack(cube, {.gap_per_radius = 0}), std::invalid_argument);
  CHECK_THROWS_AS(pack(triangle_mesh{}), std::invalid_argument);
  CHECK_THROWS_AS(pack(shapes::moebius()), std::invalid_argument);
}

TEST_CASE("real robots are packed within the laws", "[data]") {
  const std::filesystem::path folder = std::filesystem::path(CLEARANCE_TEST_DATA) / "robots/kuka_lwr4plus_cad/meshes";
  if (!std::filesystem::exists(folder)) {
    WARN("SKIPPED: no folder " << folder);
    return;
  }
  for (const char* name : {"base.STL", "link_2.STL", "link_7.STL"}) {
    const auto mesh = shapes::binary_stl((folder / name).string());
    REQUIRE(!mesh.triangles.empty());
    const packing p = pack(mesh, {.count = 500});
    CHECK(p.spheres.size() == 500);
    check_laws(mesh, p, 300);
  }
}
