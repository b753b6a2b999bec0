// SPDX-License-Identifier: BSD-3-Clause
#include "support/volumes.hpp"
#include "support/laws.hpp"

#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace volumes_test {

using namespace testing;

TEST_CASE("A sphere never promises more distance than there is") { check_volume_laws<clearance::sphere>(); }
TEST_CASE("An axis-aligned box never promises more distance than there is") { check_volume_laws<clearance::aabb>(); }
TEST_CASE("An oriented box never promises more distance than there is") { check_volume_laws<clearance::obb>(); }
TEST_CASE("A volume of one's own obeys the same laws") { check_volume_laws<kdop14>(); }
TEST_CASE("A foreign type obeys them through its traits") { check_volume_laws<Eigen::AlignedBox3f>(); }

namespace {

/// How deep inside it says the point is, at most, and how far a point outside.
template <class V>
void check_tightness(const std::vector<ball>& balls, vec3 inside, real depth, vec3 outside, real distance) {
  using traits = clearance::bounding_volume_traits<V>;
  const V v = traits::fit(balls);
  CHECK(traits::lower_bound(v, inside) == Approx(-depth).epsilon(1e-4));
  CHECK(traits::lower_bound(v, outside) == Approx(distance).epsilon(1e-4));
}

/// Without a root it says as much as the bound does, but for rounding, and, within a box, for how deep.
template <class V>
void check_reach_is_tight() {
  dice d(17);
  verdict v;
  for (int round = 0; round < 20; ++round) {
    std::vector<ball> balls(8);
    for (ball& b : balls) b = {d.point(1), d.number(0, 0.3)};
    const V volume = V::fit(balls);
    for (const vec3 q : d.points(200, 4)) {
      const real bound = volume.lower_bound(q);
      if (bound < 0.02f) continue;
      v.require(volume.may_reach(q, bound * 1.001f), "ruled out, though not by the bound");
      v.require(!volume.may_reach(q, bound * 0.999f), "not ruled out, though the bound does");
    }
    v.require(!volume.may_reach(balls[0].center, -infinity), "within a reach of minus infinity");
    v.require(!volume.may_reach({clearance::not_a_number, 0, 0}, infinity), "no point is within reach");
  }
}

}  // namespace

TEST_CASE("A volume that tells without a root whether it is within reach tells what its bound does") {
  check_reach_is_tight<clearance::sphere>();
  check_reach_is_tight<clearance::aabb>();
  check_reach_is_tight<clearance::obb>();
}

TEST_CASE("A volume around one ball is as deep as the ball, and around a box as the box") {
  const std::vector<ball> one = {{{1, 2, 3}, 0.5f}};
  check_tightness<clearance::sphere>(one, {1, 2, 3}, 0.5f, {1, 2, 5}, 1.5f);
  check_tightness<clearance::aabb>(one, {1, 2, 3}, 0.5f, {1, 2, 5}, 1.5f);
  check_tightness<clearance::obb>(one, {1, 2, 3}, 0.5f, {1, 2, 5}, 1.5f);
  std::vector<ball> box;
  for (int k = 0; k < 8; ++k) box.push_back({{k & 1 ? 3.f : -3.f, k & 2 ? 2.f : -2.f, k & 4 ? 1.f : -1.f}, 0});
  check_tightness<clearance::aabb>(box, {2.5f, 0, 0}, 0.5f, {6, 6, 1}, 5);
  check_tightness<clearance::obb>(box, {2.5f, 0, 0}, 0.5f, {6, 6, 1}, 5);
}

TEST_CASE("An oriented box turns with a turned box") {
  dice d(3);
  for (int round = 0; round < 50; ++round) {
    const Eigen::Matrix3f turn = d.pose(0).linear().cast<float>();
    std::vector<ball> box;
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector3f p = turn * Eigen::Vector3f(k & 1 ? 4 : -4, k & 2 ? 1 : -1, k & 4 ? 0.25f : -0.25f);
      box.push_back({{p.x(), p.y(), p.z()}, 0});
    }
    const auto fitted = clearance::obb::fit(box);
    std::array half = {fitted.half[0], fitted.half[1], fitted.half[2]};
    std::sort(half.begin(), half.end());
    CHECK(half[0] == Approx(0.25).epsilon(1e-3));
    CHECK(half[1] == Approx(1).epsilon(1e-3));
    CHECK(half[2] == Approx(4).epsilon(1e-3));
  }
}

TEST_CASE("A sphere around two balls is hardly larger than the smallest") {
  dice d(37);
  verdict v;
  for (int round = 0; round < 200; ++round) {
    const std::vector<ball> two{{d.point(1), d.number(0, 0.2)}, {d.point(1), d.number(0, 0.2)}};
    const real apart = length(two[1].center - two[0].center);
    const real least = std::max({(apart + two[0].radius + two[1].radius) / 2, two[0].radius, two[1].radius});
    v.require(clearance::sphere::fit(two).radius <= 1.01f * least, "not ", least, " but ",
              clearance::sphere::fit(two).radius);
  }
}

TEST_CASE("The balls of a box are at its corners, each at another") {
  dice d(29);
  std::vector<ball> inside(8);
  for (ball& b : inside) b = {d.point(1), d.number(0, 0.3)};
  const auto box = clearance::obb::fit(inside);
  const auto balls = box.balls();
  for (int k = 0; k < 8; ++k) {
    vec3 corner = box.center;
    for (int a = 0; a < 3; ++a) corner = clearance::fma(k >> a & 1 ? box.half[a] : -box.half[a], box.axis[a], corner);
    CHECK(std::ranges::count_if(balls, [&](const ball& b) { return length(b.center - corner) < 1e-5f; }) == 1);
  }
  const auto straight = clearance::aabb::fit(inside);
  const auto its = straight.balls();
  for (int k = 0; k < 8; ++k) {
    const auto at = [&](int axis, real low, real high) { return k >> axis & 1 ? high : low; };
    const vec3 l = straight.lower, h = straight.upper, corner{at(0, l.x, h.x), at(1, l.y, h.y), at(2, l.z, h.z)};
    CHECK(std::ranges::count_if(its, [&](const ball& b) { return length(b.center - corner) < 1e-5f; }) == 1);
  }
}

TEST_CASE("A bound of a point that is not a number is no bound to go by") {
  const std::vector<ball> balls = {{{1, 2, 3}, 0.5f}, {{2, 2, 2}, 0.5f}};
  const vec3 nowhere{clearance::not_a_number, 0, 0};
  CHECK_FALSE(clearance::sphere::fit(balls).lower_bound(nowhere) <= infinity);
}

}  // namespace volumes_test
