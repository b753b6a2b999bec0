// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "packing/laws.hpp"
#include "support/places.hpp"
#include "support/random.hpp"

#include <clearance/packing/pack.hpp>

#include <filesystem>

/// Checks what every packer must do, on any machine and in any order: `pack(mesh, options)` is one.
namespace packer_laws {

using namespace packing_laws;
constexpr double inf = std::numeric_limits<double>::infinity();

/// `missed`: metres by which the sampled gap may fall short of the true one; it depends on where the spheres happen to
/// be.
template <class Pack>
void keeps_the_laws(Pack pack, double missed = 3e-5) {
  using namespace shapes;
  const auto cube = box({0, 0, 0}, {1, 1, 1});
  const struct {
    triangle_mesh mesh;
    std::size_t count;
  } cases[] = {
      {cube, 700},
      {inverted(cube), 50},
      {globe({5, -3, 2}, 0.02), 200},
      {box({0, 0, 0}, {1, 1, 0.01}), 300},                         // a thin plate
      {merged(cube, globe({1, 0.5, 0.5}, 0.6)), 200},              // overlapping shells
      {merged(cube, inverted(globe({0.5, 0.5, 0.5}, 0.3))), 200},  // a cavity
      {merged(box({-1, -1, -1}, {2, 2, 2}), cube), 100},           // nested shells of one orientation
      {merged(cube, box({3, 0, 0}, {4, 2, 1})), 100},              // two pieces
      {box({0, 0, 0}, {1000, 800, 50}), 100},                      // millimetres
      {box({1000, 1000, 1000}, {1000.1, 1000.1, 1000.1}), 50},     // far from its origin
      {torus(1, 0.25), 200},
  };
  for (const auto& c : cases) {
    const packing p = pack(soup(c.mesh), {.count = c.count});
    CHECK(p.spheres.size() == c.count);
    CHECK(p.stopped_by == pack_stop::count);
    check_laws(c.mesh, p);
    CHECK(p.gap <= 1.03 * met_gap(mesh_solid(c.mesh), p) + missed);
  }
}

/// Within a few per cent of the host; it may be better.
template <class Pack>
void is_as_good_as_the_host(Pack pack) {
  for (const auto& mesh : {shapes::box({0, 0, 0}, {1, 0.7, 0.9}),
                           shapes::merged(shapes::box({0, 0, 0}, {1, 2, 1}), shapes::globe({0.5, 2, 0.5}, 0.7))}) {
    const packing here = pack(mesh, {.count = 600}), there = clearance::pack(mesh, {.count = 600});
    CHECK(here.fill > 0.98 * there.fill);
    CHECK(here.gap < 1.1 * there.gap);
    CHECK(here.gap_mean < 1.05 * there.gap_mean);
    CHECK(here.gap_p95 < 1.05 * there.gap_p95);
  }
  const packing corners = pack(shapes::box({0, 0, 0}, {1, 1, 1}), {.count = 9, .gap_per_radius = inf});
  CHECK(corners.spheres[0].radius == Approx(0.5).epsilon(1e-3));
  const double corner = 0.5 * (std::sqrt(3.0) - 1) / (std::sqrt(3.0) + 1);
  for (int i = 1; i < 9; ++i) CHECK(corners.spheres[i].radius == Approx(corner).epsilon(1e-2));
}

template <class Pack>
void repeats_itself(Pack pack) {
  const auto mesh = shapes::merged(shapes::box({0, 0, 0}, {1, 0.7, 0.9}), shapes::globe({1, 0.5, 0.5}, 0.4));
  const packing one = pack(mesh, {.count = 900, .seed = 1});
  for (int i = 0; i < 3; ++i) CHECK(same(one, pack(mesh, {.count = 900, .seed = 1})));
  const packing other = pack(mesh, {.count = 900, .seed = 2});
  CHECK_FALSE(same(one, other));
  CHECK(one.fill == Approx(other.fill).epsilon(0.03));
}

template <class Pack>
void stops_for_each_reason(Pack pack) {
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
  check_laws(cube, p, 500);
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

template <class Pack>
void lets_spheres_overlap(Pack pack) {
  const auto mesh = shapes::box({0, 0, 0}, {1, 0.5, 0.25});
  const packing apart = pack(mesh, {.count = 200}), overlapping = pack(mesh, {.count = 200, .allow_overlap = true});
  check_laws(mesh, overlapping, 1000, true);
  CHECK(overlapping.gap < apart.gap);
}

template <class Pack>
void refuses_what_makes_no_sense(Pack pack) {
  const auto cube = shapes::box({0, 0, 0}, {1, 1, 1});
  CHECK_THROWS_AS(pack(cube, {.smallest_radius = -1}), std::invalid_argument);
  CHECK_THROWS_AS(pack(cube, {.gap_target = std::nan("")}), std::invalid_argument);
  CHECK_THROWS_AS(pack(cube, {.seconds = -1}), std::invalid_argument);
  CHECK_THROWS_AS(pack(cube, {.gap_per_radius = 0}), std::invalid_argument);
  CHECK_THROWS_AS(pack(triangle_mesh{}, {}), std::invalid_argument);
  CHECK_THROWS_AS(pack(shapes::moebius(), {}), std::invalid_argument);
  auto bad = cube;
  bad.vertices[3].y() = std::nan("");
  CHECK_THROWS_AS(pack(bad, {}), std::invalid_argument);
}

/// In a soup of triangles passages are walls, where no surface is: no sphere has its middle beyond one.
template <class Pack>
void stays_within_a_flood(Pack pack) {
#if defined(CLEARANCE_SANITIZED)
  constexpr unsigned soups = 1;  // each is a flood
#else
  constexpr unsigned soups = 3;
#endif
  for (unsigned k = 1; k <= soups; ++k) {
    testing::dice d(k);
    triangle_mesh mesh;
    for (std::uint32_t i = 0; i < 900; i += 3) {
      const Vector3d at(d.number(0, 1), d.number(0, 1), d.number(0, 1));
      for (int c = 0; c < 3; ++c)
        mesh.vertices.push_back(at + Vector3d(d.number(-0.2f, 0.2f), d.number(-0.2f, 0.2f), d.number(-0.2f, 0.2f)));
      mesh.triangles.push_back({i, i + 1, i + 2});
    }
    const mesh_solid soup(mesh);
    REQUIRE(soup.mesh().inside == inside_by::flood);
    const packing p = pack(mesh, {.count = 300});
    CHECK(p.spheres.size() > 200);
    int outside = 0;
    for (const inner_sphere& s : p.spheres) outside += !soup.inside(Vector3d(s.center.x, s.center.y, s.center.z));
    CHECK(outside == 0);
  }
}

/// Plates, needles and wedges that are thinner and thinner: spheres that keep the laws, or none and a reason; and an
/// end.
template <class Pack>
void ends_on_thin_bodies(Pack pack, double thinnest = 1e-7) {
  int packed = 0, given_up = 0;
  for (double thin = 1e-2; thin > 0.9 * thinnest; thin /= 10) {
    auto wedge = shapes::box({0, 0, 0}, {1, 1, thin});
    for (auto& v : wedge.vertices)
      if (v.x() > 0.5) v.z() *= 0.5, v.y() += 0.3;  // nearly coplanar, and askew
    for (const auto& mesh : {shapes::box({0, 0, 0}, {1, 1, thin}), shapes::box({0, 0, 0}, {1, thin, thin}), wedge}) {
      INFO(thin << " of " << mesh.vertices.back().transpose());
      const packing p = pack(mesh, {.count = 5});
      if (p.spheres.empty()) {
        ++given_up;
        CHECK((p.stopped_by == pack_stop::search_limit || p.stopped_by == pack_stop::no_room));
        CHECK(std::isinf(p.gap));
        CHECK(p.room >=
              thin / 4);     // the largest that fits is not above what is said; a wedge is half as thick on average
        CHECK(thin < 5e-5);  // in thicker ones every packer finds spheres
      } else {
        ++packed;
        CHECK(p.radius_max <= thin / 2);
        check_laws(mesh, p, 300);
      }
    }
  }
  CHECK(packed >= (thinnest < 1e-4 ? 9 : 6));
  CHECK((given_up > 0) == (thinnest < 1e-6));
}

template <class Pack>
void packs_real_links(Pack pack, std::size_t count, std::initializer_list<const char*> names) {
  const std::filesystem::path folder = std::filesystem::path(testing::data("/robots/kuka_lwr4plus_cad/meshes"));
  if (!std::filesystem::exists(folder)) {
    WARN("SKIPPED: no folder " << folder);
    return;
  }
  for (const char* name : names) {
    const auto mesh = shapes::binary_stl((folder / name).string());
    REQUIRE(!mesh.triangles.empty());
    const packing p = pack(mesh, {.count = count});
    CHECK(p.spheres.size() == count);
    check_laws(mesh, p, 300);
    if (count < 1000) continue;
    CHECK(p.fill > 0.97 * clearance::pack(mesh, {.count = count}).fill);
  }
}

}  // namespace packer_laws
