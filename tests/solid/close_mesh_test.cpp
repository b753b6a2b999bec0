// SPDX-License-Identifier: BSD-3-Clause
#include "solid/shapes.hpp"
#include "support/catch.hpp"

#include <clearance/solid/close_mesh.hpp>

#include <random>

namespace close_mesh_test {

using namespace clearance;

namespace {

bool without_boundary(const closed_mesh& m) { return boundary(edge_uses(m.surface.triangles, m.counts)).empty(); }

}  // namespace

TEST_CASE("a soup of triangles is welded to the mesh it was") {
  const auto cube = shapes::box({0, 0, 0}, {1, 1, 1});
  const closed_mesh m = close_mesh(shapes::soup(cube));
  CHECK(m.surface.vertices.size() == 8);
  CHECK(m.welded == 28);
  CHECK(m.loaded == 12);
  CHECK(m.closed);
  CHECK(m.caps.loops == 0);
  CHECK(m.flipped == 0);
  CHECK(m.area == Approx(6));
}

TEST_CASE("0 and -0 are one coordinate") {
  auto mesh = shapes::soup(shapes::box({0, 0, 0}, {1, 1, 1}));
  for (std::size_t i = 0; i < mesh.vertices.size(); i += 2)
    for (int k = 0; k < 3; ++k)
      if (mesh.vertices[i][k] == 0) mesh.vertices[i][k] = -0.0;
  CHECK(close_mesh(mesh).surface.vertices.size() == 8);
}

TEST_CASE("a hole gets a cap of its own area, behind the loaded triangles") {
  auto mesh = shapes::box({0, 0, 0}, {1, 2, 3});
  const auto whole = mesh;
  mesh.triangles.resize(10);  // without the side x = 1
  const closed_mesh m = close_mesh(mesh);
  CHECK(m.closed);
  CHECK(m.caps.loops == 1);
  CHECK(m.caps.area == Approx(6));
  CHECK(m.loaded == 10);
  CHECK(without_boundary(m));
  for (std::size_t i = 0; i < 10; ++i) CHECK((m.surface.triangles[i] == whole.triangles[i]));
  const closed_mesh declined = close_mesh(mesh, {.cap = false});
  CHECK_FALSE(declined.closed);
  CHECK(declined.surface.triangles.size() == 10);
}

TEST_CASE("a flat cap with a bay is cut into ears and covers the bay's outside nowhere") {
  // A prism over an L, its lid left out.
  const Eigen::Vector2d l[6] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  triangle_mesh mesh;
  for (const double z : {0.0, 1.0})
    for (const auto& p : l) mesh.vertices.emplace_back(p.x(), p.y(), z);
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    mesh.triangles.push_back({i, j, j + 6});
    mesh.triangles.push_back({i, j + 6, i + 6});
  }
  const closed_mesh m = close_mesh(mesh);
  CHECK(m.caps.loops == 2);
  CHECK(m.caps.area == Approx(2 * 3));
  CHECK(m.surface.vertices.size() == 12);
  CHECK(without_boundary(m));
}

TEST_CASE("triangles that disagree with their neighbours are turned, and a piece inside out is left so") {
  std::mt19937 random(1);
  auto mesh = shapes::merged(shapes::globe({0, 0, 0}, 1), shapes::inverted(shapes::globe({0, 0, 0}, 0.5)));
  const auto before = mesh;
  std::uint32_t turned = 0;
  for (auto& t : mesh.triangles)
    if (random() % 8 == 0) std::swap(t[1], t[2]), ++turned;
  const closed_mesh m = close_mesh(mesh);
  CHECK(m.flipped == turned);
  CHECK(m.closed);
  CHECK(m.caps.loops == 0);
  CHECK((m.surface.triangles == before.triangles));
}

TEST_CASE("a mesh that stores each face for both sides counts each once") {
  const auto cube = shapes::box({0, 0, 0}, {1, 1, 1});
  const closed_mesh m = close_mesh(shapes::merged(cube, shapes::inverted(cube)));
  CHECK(m.duplicate == 12);
  CHECK(m.caps.loops == 0);
  CHECK(std::count(m.counts.begin(), m.counts.end(), true) == 12);
  CHECK(m.loaded == 24);
}

TEST_CASE("two boxes that share a wall are closed as they are") {
  const auto mesh = shapes::merged(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 0, 0}, {2, 1, 1}));
  const closed_mesh m = close_mesh(mesh);
  CHECK(m.closed);
  CHECK(without_boundary(m));
  CHECK(m.flipped == 0);
}

TEST_CASE("degenerate triangles are counted and kept") {
  auto mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({0, 1, 0});
  mesh.vertices.emplace_back(0.5, 0.5, 0.0);  // on the line 1, 2
  mesh.triangles.push_back({1, 8, 2});
  const closed_mesh m = close_mesh(mesh);
  CHECK(m.degenerate == 3);
  CHECK(m.loaded == 15);
  CHECK(m.closed);
  CHECK(without_boundary(m));
}

TEST_CASE("a Moebius strip is said to have no two sides") {
  const closed_mesh m = close_mesh(shapes::moebius());
  CHECK(m.one_sided_area == Approx(m.area));
  CHECK(close_mesh(shapes::globe({0, 0, 0}, 1)).one_sided_area == 0);
}

TEST_CASE("any soup at all is closed by its caps") {
  std::mt19937 random(4);
  for (int round = 0; round < 50; ++round) {
    triangle_mesh mesh;
    for (int i = 0; i < 9; ++i) mesh.vertices.emplace_back(i % 3, i / 3, double(random() % 7));
    for (int i = 0; i < 30; ++i)
      mesh.triangles.push_back({std::uint32_t(random() % 9), std::uint32_t(random() % 9), std::uint32_t(random() % 9)});
    CHECK(without_boundary(close_mesh(mesh)));
    CHECK(without_boundary(close_mesh(mesh, {.orient = false})));
  }
}

TEST_CASE("what is no mesh is refused with a reason") {
  const auto reason = [](const triangle_mesh& m) {
    try {
      close_mesh(m);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  const auto cube = shapes::box({0, 0, 0}, {1, 1, 1});
  auto bad = cube;
  bad.triangles.clear();
  CHECK(reason(bad).find("no triangles") != std::string::npos);
  bad = cube;
  bad.vertices[3].y() = std::nan("");
  CHECK(reason(bad).find("not finite or beyond 1e15 m: number 3") != std::string::npos);
  bad.vertices[3].y() = 1e300;
  CHECK(reason(bad).find("not finite") != std::string::npos);
  bad = cube;
  bad.triangles[5][1] = 8;
  CHECK(reason(bad).find("triangle 5 names vertex 8 of 8") != std::string::npos);
  bad = cube;
  for (auto& v : bad.vertices) v.y() = v.z() = v.x();
  CHECK(reason(bad).find("degenerate") != std::string::npos);
  bad = {{{0, 0, 0}, {0, 1e-3, 0}, {1e12, 0, 0}}, {{0, 1, 2}, {1, 0, 2}}};  // so long that its near corners are one
  CHECK(reason(bad).find("degenerate") != std::string::npos);
}

}  // namespace close_mesh_test
