// SPDX-License-Identifier: BSD-3-Clause
#include "packing/packers.hpp"

#include <clearance/packing/pack.hpp>
#include <clearance/solid/implicit.hpp>

using namespace packer_laws;

namespace {

packing one_by_one(const triangle_mesh& mesh, const pack_options& options) { return pack(mesh, options); }

}  // namespace

TEST_CASE("spheres lie inside, apart, in order, and the gap is certified") { keeps_the_laws(one_by_one, 5e-5); }

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

TEST_CASE("packing stops for each of its reasons") { stops_for_each_reason(one_by_one); }

TEST_CASE("spheres that may overlap leave a smaller gap") { lets_spheres_overlap(one_by_one); }

TEST_CASE("packing ends on thin plates and needles, with spheres or with a reason") { ends_on_thin_bodies(one_by_one); }
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

TEST_CASE("options and solids that make no sense are refused") { refuses_what_makes_no_sense(one_by_one); }

TEST_CASE("real robots are packed within the laws", "[data]") {
  packs_real_links(one_by_one, 500, {"base.STL", "link_2.STL", "link_7.STL"});
}
