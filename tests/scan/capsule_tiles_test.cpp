// SPDX-License-Identifier: BSD-3-Clause
// What is left out of a scan of capsules has none within reach.
#include "support/laws.hpp"

#include <clearance/make_model.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/scan/tile_scan.hpp>
#include <clearance/volume/sphere.hpp>

namespace capsule_tiles_test {

using namespace testing;
using clearance::capsule, clearance::extent, clearance::scan::capsule_hull;

namespace {

vec3 clamped(vec3 p, const extent& box) {
  return {std::clamp(p.x, box.lower.x, box.upper.x), std::clamp(p.y, box.lower.y, box.upper.y),
          std::clamp(p.z, box.lower.z, box.upper.z)};
}

}  // namespace

TEST_CASE("A hull of capsules may touch what one of them touches, and not what is far from all") {
  verdict v;
  dice d(67);
  std::size_t touched = 0, apart = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    capsule_hull hull;
    const vec3 from = d.point(2), to = d.point(2);
    std::vector<capsule> all;
    for (int k = 0; k < 4; ++k) {
      const vec3 start = d.point(0.2, from), end = d.point(0.2, to);
      hull.starts.add(start), hull.ends.add(end);
      all.push_back({start, end - start, 0});
    }
    const vec3 corner = d.point(2);
    extent box;
    box.add(corner), box.add(corner + d.point(0.6));
    bool touches = false;
    real away = infinity;
    for (const capsule& c : all)
      for (int k = 0; k <= 64; ++k) {
        const vec3 p = c.at(real(k) / 64), q = clamped(p, box);
        touches = touches || p == q;
        away = std::min(away, length(p - q));
      }
    v.require(!touches || hull.may_touch(box, 0), "it may not touch what one of its own touches");
    v.require(away > 0.1f || hull.may_touch(box, 0.1f), "nor what is as near as it was told");
    v.require(away < 0.8f || !hull.may_touch(box, 0), "it may touch what is ", away, " away");
    touched += touches, apart += away > 0.8f;
  }
  CHECK(touched > 100);
  CHECK(apart > 100);
}

TEST_CASE("A bound on a sphere's distance from a capsule is below it, and hardly") {
  verdict v;
  dice d(68);
  for (int trial = 0; trial < 500; ++trial) {
    const clearance::sphere s{d.point(1), d.number(0, 0.5)};
    const vec3 along = d.point(1);
    const capsule c{d.point(2), along, d.number(0, 0.5)};
    double away = infinity;
    for (int k = 0; k <= 1000; ++k) away = std::min<double>(away, length(c.at(real(k) / 1000) - s.center));
    const real bound = lower_bound(s, c, infinity);
    v.require(bound <= away - s.radius - c.radius, "above");
    v.require(bound >= away - s.radius - c.radius - 0.002, "far below");
  }
}

TEST_CASE("A cloud whose size is no multiple of a tile's is read to its end, and no further") {
  const auto part =
      clearance::make_part(clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{0, 0, 0}, 1}}));
  std::vector<vec3> points(3 * clearance::scan::capsule_tile::points, vec3{9, 0, 0});
  for (const std::size_t size : {points.size() / 3 - 1, points.size() / 3, points.size() / 3 + 1}) {
    auto all = points;
    std::fill(all.begin() + std::ptrdiff_t(size), all.end(), vec3{clearance::not_a_number, 0, 0});
    all[size - 1].x = 3;
    const auto balls =
        clearance::uncertain(clearance::point_span(all.data(), size), clearance::no_noise{}, {.shift = 0.5f});
    const auto r = ask(clearance::host{}, part, Eigen::Isometry3d::Identity(), balls, clearance::min_distance{});
    CHECK(r.valid == size);
    CHECK(r.dropped[int(clearance::drop_reason::not_finite)] == 0);
    CHECK(r.point == size - 1);
  }
}

}  // namespace capsule_tiles_test
