// SPDX-License-Identifier: BSD-3-Clause
#include "solid/shapes.hpp"
#include "support/catch.hpp"

#include <clearance/solid/close_mesh.hpp>
#include <clearance/solid/winding.hpp>

#include <random>

namespace winding_test {

using namespace clearance;

namespace {

/// The generalized winding number (Jacobson 2013), a sum of solid angles, in long double, of the rounded triangles. No
/// whole number for points on the surface.
long double solid_angles(const std::vector<crossing_triangle<float>>& triangles, vec3 p) {
  long double sum = 0;
  for (const auto& t : triangles) {
    long double v[3][3], l[3];
    for (int j = 0; j < 3; ++j) {
      const long double d[3] = {t.v[j][0] - (long double)p.x, t.v[j][1] - (long double)p.y,
                                t.v[j][2] - (long double)p.z};
      for (int k = 0; k < 3; ++k) v[j][k] = d[k];
      l[j] = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    const auto dot = [&](int i, int j) { return v[i][0] * v[j][0] + v[i][1] * v[j][1] + v[i][2] * v[j][2]; };
    const long double det = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) -
                            v[0][1] * (v[1][0] * v[2][2] - v[1][2] * v[2][0]) +
                            v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
    const long double half =
        std::atan2(det, l[0] * l[1] * l[2] + dot(0, 1) * l[2] + dot(1, 2) * l[0] + dot(2, 0) * l[1]);
    if (std::abs(half) > std::numbers::pi_v<long double> - 1e-4L) return 0.5L;
    sum += 2 * half;
  }
  return sum / (4 * std::numbers::pi_v<long double>);
}

/// Random points, and points that share coordinates with vertices, edges and faces.
std::vector<vec3> probes(const winding<>& w, std::mt19937& random, int count) {
  std::uniform_real_distribution<float> unit(0, 1);
  const auto& g = w.grid;
  std::vector<vec3> points;
  for (int i = 0; i < count; ++i) {
    float p[3];
    for (int k = 0; k < 3; ++k) p[k] = g.low[k] + (1.2f * unit(random) - 0.1f) * (g.high[k] - g.low[k]);
    const auto& t = w.triangles[random() % w.triangles.size()];
    const auto& u = t.v[random() % 3];
    const auto& v = t.v[random() % 3];
    switch (i % 4) {
      case 1:
        p[1] = u[1], p[2] = u[2];
        break;  // the ray meets a vertex
      case 2:
        p[1] = (u[1] + v[1]) / 2, p[2] = (u[2] + v[2]) / 2;
        break;  // and perhaps an edge
      case 3:
        p[i / 4 % 3] = u[i / 4 % 3];
        break;
      default:
        break;
    }
    points.push_back({p[0], p[1], p[2]});
  }
  return points;
}

void agree(const triangle_mesh& mesh, int count = 2000) {
  const closed_mesh closed = close_mesh(mesh);
  const auto w = make_winding(closed);
  const auto exact = make_winding<double>(closed);
  std::mt19937 random(1);
  int asked = 0, wrong = 0, wrong_in_double = 0;
  for (const vec3 p : probes(w, random, count)) {
    const long double expected = solid_angles(w.triangles, p), whole = std::round(expected);
    if (std::abs(expected - whole) > 1e-6L) continue;  // on the surface
    ++asked;
    wrong += w.view().winding(p) != int(whole);
    wrong_in_double += exact.view().winding(p) != int(whole);
  }
  CHECK(asked > count / 4);
  CHECK(wrong == 0);
  CHECK(wrong_in_double <= asked / 100);  // its vertices are not rounded to float: they differ near the surface
}

}  // namespace

TEST_CASE("winding numbers equal the sum of solid angles") {
  using namespace shapes;
  const auto cube = box({-1, -1, -1}, {1, 1, 1});
  const auto sphere = globe({0.25, 0, 0.5}, 0.75);
  agree(cube);
  agree(soup(cube));
  agree(sphere);
  agree(inverted(sphere));
  agree(merged(cube, sphere));                                        // overlapping shells
  agree(merged(cube, box({0.5, -1, -1}, {2, 1, 1})));                 // partly coplanar
  agree(merged(cube, inverted(box({-.5, -.5, -.5}, {.5, .5, .5}))));  // a cavity
  agree(merged(cube, cube));
}

TEST_CASE("winding numbers are whole for open meshes once they are capped") {
  std::mt19937 random(2);
  for (int round = 0; round < 8; ++round) {
    auto mesh = shapes::merged(shapes::globe({0, 0, 0}, 1), shapes::box({0.5, 0.5, 0.5}, {2, 2, 2}));
    for (auto& t : mesh.triangles)
      if (random() % 16 == 0) std::swap(t[0], t[1]);
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    mesh.triangles.resize(mesh.triangles.size() * 3 / 4);
    agree(mesh, 500);
  }
}

TEST_CASE("winding numbers of random triangles, closed by their caps, equal the sum of solid angles") {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> few(0, 4);  // many shared coordinates, edges and planes
  for (int round = 0; round < 20; ++round) {
    triangle_mesh mesh;
    for (int i = 0; i < 12; ++i) {
      for (int k = 0; k < 3; ++k) mesh.vertices.emplace_back(few(random), few(random), few(random));
      mesh.triangles.push_back({std::uint32_t(3 * i), std::uint32_t(3 * i + 1), std::uint32_t(3 * i + 2)});
    }
    agree(mesh, 400);
  }
}

TEST_CASE("points far away, beside, or not finite are outside") {
  const auto w = make_winding(close_mesh(shapes::box({0, 0, 0}, {1, 1, 1})));
  const float nan = not_a_number, inf = infinity;
  for (const vec3 p :
       {vec3{2, .5f, .5f}, vec3{-1, .5f, .5f}, vec3{.5f, 1.5f, .5f}, vec3{.5f, .5f, -1e30f}, vec3{nan, .5f, .5f},
        vec3{.5f, nan, .5f}, vec3{.5f, .5f, nan}, vec3{inf, .5f, .5f}, vec3{.5f, -inf, .5f}})
    CHECK_FALSE(w.view().inside(p));
  CHECK(w.view().inside(vec3{.5f, .5f, .5f}));
}

TEST_CASE("an open mesh whose caps were declined has no winding number") {
  auto mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.pop_back();
  CHECK_THROWS_AS(make_winding(close_mesh(mesh, {.cap = false})), std::invalid_argument);
  CHECK(make_winding(close_mesh(mesh)).view().inside(vec3{.5f, .5f, .5f}));
}

}  // namespace winding_test
