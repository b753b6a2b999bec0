// SPDX-License-Identifier: BSD-3-Clause
// A search, at random and uphill, for a bound that is above the truth, and what such searches have found.
// tests/bounds/search-bounds takes far more cases, by two compilers and with and without fused operations.
#include "bounds/rows.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"

#include <clearance/ground/vectors.hpp>
#include <clearance/points/sensor_noise.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/questions/within.hpp>

namespace bounds_test {

using clearance::real, clearance::vec3, clearance::triangle;

TEST_CASE("No search finds a bound above the truth") {
  constexpr std::uint64_t cases = 60000;  // of each search
  std::uint64_t all = 0;
  bounds::each_row(cases, 1, [&](const std::string& name, auto run) {
    const bounds::row r = run();
    INFO(name << ": law " << r.law << " has " << r.least << " units left at" << r.at);
    CHECK(r.broken == 0);
    CHECK(r.least < 100);  // it comes near
    all += r.cases;
  });
  CHECK(all > 15 * cases);
}

namespace {

/// An inner sphere's distance, less one unit of rounding, which is too little for a bound.
struct raised {
  static constexpr std::size_t content = 0, numbers = 3;
  static void draw(std::array<float, numbers>& x, std::size_t, bounds::chance& c) {
    bounds::draw_near(x.data(), 3, {0, 0, 0}, 4, c);
  }
  bounds::room operator()(const std::array<float, numbers>& x) const {
    const clearance::inner_sphere s{{0, 0, 0}, 1};
    const vec3 q = bounds::vector_at(x.data());
    const double exact = bounds::about<clearance::inner_sphere>::distance(s, reference::wider<double>(q));
    bounds::room r;
    const double scale = bounds::unit * (std::abs(exact) + 1), bound = double(s.distance(q)) - scale;
    r.add((exact - bound) / scale, 0);
    return r;
  }
};

}  // namespace

TEST_CASE("A search finds a bound that is too high by a fraction of a unit of rounding, and says where") {
  const auto f = bounds::search(raised{}, 20000, 7);
  CHECK(f.broken > 0);
  CHECK(raised{}(f.at).left == f.least);
}

TEST_CASE("A box about the origin is wider than its content by a share of its own size") {
  // A side along y whose ends are about as far from the origin, and a point before one end.
  constexpr std::array<float, 15> at = {
      0x0p+0, -0x1.88bee4p-14f, 0x0p+0,          0x0p+0, -0x1.8ae9fp-10f,  0x0p+0,         0x0p+0,    0x1.89d43ep-10f,
      0x0p+0, 0x1p-149f,        0x1.89ff22p-10f, 0x0p+0, -0x1.5a1438p-19f, 0x1.61d55ap-9f, -0x1p-149f};
  CHECK(bounds::volume_law<clearance::aabb, triangle>{}(at).left > 10);
}

TEST_CASE("An exact distance is the least over many places of a triangle, and of a way") {
  testing::dice d(3);
  for (int round = 0; round < 300; ++round) {
    using L = long double;
    const auto draw = [&] { return reference::wider<L>(d.point(1)); };
    const auto a = draw(), b = round % 3 == 0 ? a + 1e-3L * draw() : draw(), c = draw(), p = draw(), q = draw();
    L least = 1e9L, of_way = 1e9L;
    constexpr int n = 40;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const auto at = a + (L(i) / n) * (b - a) + (L(j) / n) * (c - a);
        least = std::min(least, reference::length(p - at));
        of_way = std::min(of_way, reference::length(reference::nearest_of_segment(p - at, q - at)));
      }
    const L exact = reference::to_triangle(p, a, b, c), way = reference::segment_to_triangle(p, q, a, b, c);
    const L step = (reference::length(b - a) + reference::length(c - a)) / n;
    REQUIRE((exact <= least && least <= exact + step));
    REQUIRE((way <= of_way && of_way <= way + step));
  }
}

TEST_CASE("A product is not fused with a sum, in code for vectors either") {
  constexpr std::size_t n = 64;
  float a[n], b[n], once[n], fused[n], alone[n];
  testing::dice d(5);
  for (std::size_t i = 0; i < n; ++i) {
    a[i] = d.number(1, 2), b[i] = d.number(1, 2);
    const volatile float rounded = a[i] * b[i];
    once[i] = rounded;
  }
  clearance::with_vectors([&] {
    for (std::size_t i = 0; i < n; ++i) fused[i] = clearance::product(a[i], b[i]) - once[i];
  });
  for (std::size_t i = 0; i < n; ++i) alone[i] = clearance::product(a[i], b[i]) - once[i];
  for (std::size_t i = 0; i < n; ++i) {
    CHECK(fused[i] == 0);
    CHECK(alone[i] == 0);
  }
}

TEST_CASE("Small triangles far from their part's origin list the balls that touch them") {
  testing::dice d(9);
  std::vector<triangle> faces;
  const vec3 away{30, 20, 10};
  for (int i = 0; i < 200; ++i) faces.push_back(d.face(0.1, 0.001, away));
  std::vector<vec3> points;
  for (const triangle& t : faces) {
    const vec3 middle{(t.a.x + t.b.x + t.c.x) / 3, (t.a.y + t.b.y + t.c.y) / 3, (t.a.z + t.b.z + t.c.z) / 3};
    for (int k = 0; k < 40; ++k) points.push_back(middle + d.point(1e-5));
  }
  const auto balls = clearance::uncertain(clearance::point_span(points), clearance::no_noise{}, {.shift = 0x1p-10f});
  const real radius = balls.around(0, points[0]).radius;
  std::size_t touching = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    real least = clearance::infinity;
    for (const triangle& t : faces)
      least = clearance::min(least, clearance::distance_to(t, balls.around(i, points[i])));
    touching += least <= -radius;
  }
  CHECK(touching > 100);
  const auto part = clearance::make_part(clearance::build<clearance::obb>(faces, {.leaf_size = 1}));
  const auto listed =
      ask(clearance::host{}, part, Eigen::Isometry3d::Identity(), balls, clearance::within{{double(-radius)}});
  CHECK(listed.pairs.size() == touching);
}

}  // namespace bounds_test
