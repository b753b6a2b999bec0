// SPDX-License-Identifier: BSD-3-Clause
// Every question against an independent reference, on made solids; tests/reference/reference asks about real ones.
#include "reference/objects.hpp"
#include "solid/shapes.hpp"
#include "support/catch.hpp"

namespace reference_test {

using namespace reference;

TEST_CASE("Every answer is what an independent reference says") {
  using clearance::triangle_mesh;
  constexpr std::uint64_t points = 20000;  // of each object
  const auto apart = [](testing::dice& d) { return std::vector{d.pose(1), d.pose(1), d.pose(1)}; };
  const std::vector<object> all = {
      {"box", {shapes::box({-0.1, -0.2, 0.3}, {0.2, 0.1, 0.7})}},
      {"torus", {shapes::torus(0.4, 0.1)}},
      {"globes beside one another", {shapes::merged(shapes::globe({0, 0, 0}, 0.2), shapes::globe({0.5, 0, 0}, 0.2))}},
      {"globe in a globe", {shapes::merged(shapes::globe({0, 0, 0}, 0.1), shapes::globe({0, 0, 0}, 0.3))}},
      {"three parts", {shapes::cube(0.2), shapes::torus(0.3, 0.1), shapes::globe({0.1, 0, 0}, 0.3)}, apart, 60}};
  tally t;
  census sum;
  for (const object& one : all) {
    objects_judge j(one, 5, t);
    j.ask(points);
    CHECK(j.counts().clean == j.counts().parts);
    sum.points += j.counts().points;
  }
  INFO(t.first());
  CHECK(t.wrong() == 0);
  CHECK(sum.points >= all.size() * points);
  CHECK(t.counts().size() == 16);
}

TEST_CASE("The reference says by itself what is inside") {
  const auto solid_of = [](const clearance::triangle_mesh& m) {
    std::vector<solid::corners> faces;
    for (const auto& f : m.triangles) {
      const auto corner = [&](int k) {
        const Eigen::Vector3d& p = m.vertices[f[std::size_t(k)]];
        return place{wide(p.x()), wide(p.y()), wide(p.z())};
      };
      faces.push_back({corner(0), corner(1), corner(2)});
    }
    return solid(std::move(faces), m.shapes);
  };
  const solid torus = solid_of(shapes::torus(0.5, 0.2)), turned = solid_of(shapes::inverted(shapes::cube(1)));
  const solid shell = solid_of(shapes::merged(shapes::cube(1), shapes::inverted(shapes::cube(0.5))));
  const solid strip = solid_of(shapes::moebius());
  CHECK((torus.clean() && turned.clean() && shell.clean() && !strip.clean()));
  CHECK(torus.where({0, 0, 0}) == side::outside);
  CHECK(torus.where({0.5L, 0, 0}) == side::inside);
  CHECK(turned.where({0.9L, 0.9L, 0.9L}) == side::inside);
  CHECK(turned.where({1.1L, 0, 0}) == side::outside);
  CHECK(shell.where({0.75L, 0, 0}) == side::inside);
  CHECK(shell.where({0, 0, 0}) == side::inside);  // a sealed cavity
  CHECK(strip.where({0, 0, 0}) == side::unknown);
  CHECK(std::abs(turned.surface({3, 0.5L, 0}) - 2) < 1e-15L);
  CHECK(std::abs(turned.surface({3, 0, 0}, {3, 0, 1}, 9) - 2) < 1e-15L);
  CHECK(turned.surface({-3, 0.1L, 0}, {3, 0.1L, 0}, 9) == 0);
}

}  // namespace reference_test
