// SPDX-License-Identifier: BSD-3-Clause
#include "solid/shapes.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

#include <clearance/solid/implicit.hpp>
#include <clearance/solid/mesh_solid.hpp>

#include <filesystem>
#include <random>

namespace mesh_solid_test {

using namespace clearance;
using Eigen::Vector3d;

namespace {

using wide = Eigen::Matrix<long double, 3, 1>;

/// Three clamped segments, and the plane by projection, in long double: another way than the library's.
long double reference(const wide& a, const wide& b, const wide& c, const wide& p) {
  const auto segment = [&](const wide& u, const wide& v) {
    const wide e = v - u;
    const long double l = e.squaredNorm();
    const long double t = l > 0 ? std::clamp((p - u).dot(e) / l, 0.0L, 1.0L) : 0.0L;
    return (p - u - t * e).norm();
  };
  long double best = std::min({segment(a, b), segment(b, c), segment(c, a)});
  const wide n = (b - a).cross(c - a);
  if (n.norm() > 0) {
    const wide q = p - n * (n.dot(p - a) / n.squaredNorm());
    if (n.dot((b - a).cross(q - a)) >= 0 && n.dot((c - b).cross(q - b)) >= 0 && n.dot((a - c).cross(q - c)) >= 0)
      best = std::min(best, std::abs(n.dot(p - a)) / n.norm());
  }
  return best;
}

long double reference(const triangle_mesh& m, const Vector3d& p) {
  long double best = std::numeric_limits<long double>::infinity();
  for (const auto& t : m.triangles)
    best = std::min(best, reference(m.vertices[t[0]].cast<long double>(), m.vertices[t[1]].cast<long double>(),
                                    m.vertices[t[2]].cast<long double>(), p.cast<long double>()));
  return best;
}

std::string reason(const triangle_mesh& m) {
  try {
    mesh_solid{m};
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("the distance to a mesh solid is exact, slivers included") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  auto mesh = shapes::merged(shapes::globe({0, 0, 0}, 1), shapes::box({0.2, 0.2, 0.2}, {1.5, 1.4, 1.3}));
  for (const double thin : {1e-3, 1e-5, 1e-7, 1e-9, 1e-12}) {
    mesh = shapes::merged(mesh, shapes::box({-2, -thin, -1}, {2, thin, -0.9}));
    triangle_mesh needle;
    needle.vertices = {{-1, 0.5, 0.5}, {1, 0.6, 0.7}, {0.3 + thin, 0.565, 0.63 + thin}};
    needle.triangles = {{0, 1, 2}};
    mesh = shapes::merged(mesh, needle);
  }
  const mesh_solid s(mesh);
  double worst = 0, worst_near = 0;
  for (int i = 0; i < 3000; ++i) {
    Vector3d p = 2 * Vector3d(unit(random), unit(random), unit(random));
    if (i % 2) p = s.corners()[random() % s.corners().size()] + p * std::pow(10, -1 - i % 7);
    const double expected = double(reference(s.mesh().surface, p));
    worst = std::max(worst, std::abs(s.distance(p) - expected));
    CHECK(s.distance(p, expected * 0.9) == expected * 0.9);
    const Vector3d q = p + 0.1 * Vector3d(unit(random), unit(random), unit(random));
    double d = 1;
    s.view().near(p, 1, [&](std::uint32_t piece) { d = s.view().nearer(piece, q, d); });
    const double there = double(reference(s.mesh().surface, q));
    if (there < 0.5) worst_near = std::max(worst_near, std::abs(d - there));
  }
  CHECK(worst < 2e-8);  // only the thinnest needle, whose plane is not asked, is that far off
  CHECK(worst_near < 2e-8);
}

TEST_CASE("the volume is what no way leads to from outside") {
  using namespace shapes;
  const auto cube = box({0, 0, 0}, {1, 1, 1});
  CHECK(mesh_solid(cube).volume() == Approx(1));
  CHECK(mesh_solid(inverted(cube)).volume() == Approx(1));
  const auto hollow =
      mesh_solid(merged(box({-1, -1, -1}, {2, 2, 2}), inverted(cube)));  // whichever way its inner wall faces
  CHECK(hollow.volume() == Approx(27).epsilon(0.005));
  CHECK(hollow.inside({0.5, 0.5, 0.5}));
  const mesh_solid overlapping(merged(cube, box({0.5, 0, 0}, {1.5, 1, 1})));
  CHECK(overlapping.overlaps());
  CHECK(overlapping.volume() == Approx(1.5).epsilon(0.005));
  CHECK_FALSE(mesh_solid(merged(cube, box({1, 0, 0}, {2, 1, 1}))).overlaps());  // touching
  CHECK(mesh_solid(merged(cube, inverted(box({3, 0, 0}, {4, 1, 1})))).volume() == Approx(2).epsilon(0.005));
  CHECK(mesh_solid(merged(cube, cube)).volume() == Approx(1));  // each face twice
}

TEST_CASE("surface points are on the surface and spread by area") {
  const mesh_solid s(shapes::box({0, 0, 0}, {1, 2, 3}));
  int at_z0 = 0;
  for (const auto& p : s.surface_points(2200)) {
    CHECK(s.distance(p) < 1e-12);
    at_z0 += p.z() == 0;
  }
  CHECK(at_z0 == Approx(200).margin(10));
}

TEST_CASE("what has no inside is refused with a reason") {
  triangle_mesh sheet;
  sheet.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  sheet.triangles = {{0, 1, 2}};
  CHECK(reason(sheet).find("it is a sheet") != std::string::npos);
  sheet.triangles = {{0, 1, 2}, {1, 3, 2}};
  CHECK(reason(sheet).find("it is a sheet") != std::string::npos);
  CHECK(reason(shapes::merged(sheet, shapes::inverted(sheet))).find("it is a sheet") != std::string::npos);
  CHECK(reason(shapes::moebius()).find("Moebius") != std::string::npos);
  CHECK(reason(shapes::globe({0, 0, 0}, 1)) == "accepted");
}

TEST_CASE("an implicit solid is its function and its bounds") {
  const auto f = [](const Vector3d& p) { return p.norm() - 1; };
  const implicit_solid s(f, Eigen::AlignedBox3d(Vector3d(-1, -1, -1), Vector3d(1, 1, 1)));
  CHECK(s.inside({0.5, 0, 0}));
  CHECK_FALSE(s.inside({1.5, 0, 0}));
  CHECK(s.distance({0.25, 0, 0}) == 0.75);
  CHECK_THROWS_AS((implicit_solid(f, Eigen::AlignedBox3d())), std::invalid_argument);
}

TEST_CASE("mesh solids of real robots are exact", "[data]") {
  const std::filesystem::path folder = std::filesystem::path(testing::data("/robots/kuka_lwr4plus_cad/meshes"));
  if (!std::filesystem::exists(folder)) {
    WARN("SKIPPED: no folder " << folder);
    return;
  }
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-0.1, 1.1);
  for (const char* name : {"base.STL", "link_2.STL", "link_7.STL"}) {
    const mesh_solid s(shapes::binary_stl((folder / name).string()));
    CHECK(s.volume() > 1e-4);
    double worst = 0;
    for (int i = 0; i < 100; ++i) {
      const Vector3d p =
          s.bounds().min() + Vector3d(unit(random), unit(random), unit(random)).cwiseProduct(s.bounds().sizes());
      worst = std::max(worst, std::abs(s.distance(p) - double(reference(s.mesh().surface, p))));
    }
    CHECK(worst < 1e-12);
  }
}

}  // namespace mesh_solid_test
