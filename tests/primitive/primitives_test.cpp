// SPDX-License-Identifier: BSD-3-Clause
#include "support/laws.hpp"

#include <clearance/ground/ordered.hpp>

namespace primitives_test {

using namespace testing;

namespace {

constexpr wide unit = 0x1p-24L;  // of rounding

wide exact(const inner_sphere& s, vec3 q) { return oracle::to_sphere(wider(q), wider(s.center), s.radius); }
wide exact(const triangle& t, vec3 q) { return oracle::to_triangle(wider(q), wider(t.a), wider(t.b), wider(t.c)); }
wide size(const inner_sphere& s) { return s.radius; }
wide size(const triangle& t) {
  return std::max({oracle::between(wider(t.a), wider(t.b)), oracle::between(wider(t.b), wider(t.c)),
                   oracle::between(wider(t.c), wider(t.a))});
}

/// The distance to within eight units of the numbers that enter it, and the witness to what floats can say.
template <class P>
void check(const P& p, vec3 q, verdict& v) {
  const ball near = p.balls()[0];
  const wide scale = oracle::between(wider(q), wider(near.center)) + size(p);
  const wide truth = exact(p, q), distance = p.distance(q);
  v.require(std::abs(distance - truth) <= 8 * unit * scale, "distance", distance, " instead of", truth, " at ", q,
            " of ", near.center, " size", size(p));
  if constexpr (clearance::foreseen_primitive<P>)
    v.require(p.may_reach(q, p.distance(q)), "ruled out at ", q, ", though", distance, " away");
  if constexpr (clearance::rootless_primitive<P>) {
    const auto before = p.before_root(q);
    const real by_root = before.distance(clearance::square_root(before.squared));
    v.require(clearance::to_bits(by_root) == clearance::to_bits(p.distance(q)), "after its root", by_root,
              " and the distance", distance, " at ", q);
  }
  if constexpr (clearance::bounded_primitive<P>)
    v.require(p.lower_bound(q) <= p.distance(q), "the lower bound is", p.lower_bound(q), " and the distance", distance,
              " at ", q);
  for (const vec3 other :
       {q, p.nearest(q), near.center, near.center - (q - near.center), vec3{q.x, near.center.y, q.z}})
    check_tangents(p, q, other, v), check_tangents(p, other, q, v);
  const vec3 at = p.nearest(q), n = p.normal(q);
  const wide written = scale + oracle::length(wider(q));  // nearest() is rounded to the grid of its coordinates
  v.require(std::abs(exact(p, at)) <= 16 * unit * written, "nearest is off the primitive by", exact(p, at), " at ", q);
  const bool centre = n == vec3{0, 0, 0};
  if (!centre) {
    v.require(std::abs(oracle::between(wider(q), wider(at)) - std::abs(truth)) <= 16 * unit * written, "nearest is",
              oracle::between(wider(q), wider(at)), " away instead of", truth, " at ", q);
    v.require(std::abs(oracle::length(wider(n)) - 1) <= 1e-6L, "the normal is no unit vector at ", q);
  }
  // Along the normal the distance grows as the step does; where rounding could hide the direction nothing is asked.
  const wide reach = oracle::between(wider(q), wider(at));
  if (!centre && reach > 1e5L * unit * written) {
    const wide step = reach / 8;
    const oracle::vec further = wider(q) + step * wider(n);
    const vec3 rounded{real(further.x), real(further.y), real(further.z)};
    v.require(exact(p, rounded) - truth >= 0.999L * step - 16 * unit * written, "the distance grows by",
              exact(p, rounded) - truth, " along a step of", step, " at ", q);
  }
}

/// Points around a triangle where formulas go wrong: over corners, edges, faces, in the plane, near and far.
std::vector<vec3> around(dice& d, const triangle& t) {
  std::vector<vec3> all = {t.a, t.b, t.c};
  const real s = real(size(t)) + 1e-12f;
  for (int k = 0; k < 40; ++k) {
    real u = d.number(-0.5, 1.5), w = d.number(-0.5, 1.5);
    if (k % 3 == 0) u = real(d.below(2)), w = real(d.below(2));
    const vec3 in_plane = clearance::fma(w, t.c - t.a, clearance::fma(u, t.b - t.a, t.a));
    all.push_back(in_plane);
    for (const double away : {1e-5, 1e-2, 1.0, 100.0}) {
      all.push_back(clearance::fma(real(away) * s, d.direction(), in_plane));
      all.push_back(clearance::fma(real(away) * s, t.unit_normal, in_plane));
    }
  }
  return all;
}

}  // namespace

TEST_CASE("The oracle agrees with distances known by hand") {
  const oracle::vec a{0, 0, 0}, b{4, 0, 0}, c{0, 3, 0};
  CHECK(double(oracle::to_triangle({1, 1, 2}, a, b, c)) == Approx(2));
  CHECK(double(oracle::to_triangle({2, -5, 0}, a, b, c)) == Approx(5));
  CHECK(double(oracle::to_triangle({7, 0, 4}, a, b, c)) == Approx(5));
  CHECK(double(oracle::to_triangle({4, 3, 0}, a, b, c)) == Approx(2.4));
  CHECK(double(oracle::to_triangle({-3, -4, 12}, a, b, c)) == Approx(13));
  CHECK(double(oracle::to_triangle({1, 1, 0}, a, b, c)) < 1e-15);
  CHECK(double(oracle::to_sphere({3, 4, 0}, a, 2)) == Approx(3));
}

TEST_CASE("The distance to an inner sphere is right, and negative inside") {
  static_assert(clearance::explain_primitive<inner_sphere>());
  dice d(1);
  verdict v;
  for (int k = 0; k < 5000; ++k) {
    const inner_sphere s = d.sphere(k % 2 ? 1 : 1000, 1e-4, 10);
    for (const vec3 q : {d.point(2), d.point(2000), s.center + d.point(s.radius), s.center,
                         clearance::fma(s.radius, d.direction(), s.center), s.center + vec3{s.radius, 0, 0}})
      check(s, q, v);
  }
  CHECK(inner_sphere{{1, 2, 3}, 0.5f}.distance({1, 2, 3}) == -0.5f);
  CHECK(inner_sphere{{1, 2, 3}, 0.5f}.distance({1, 2.25f, 3}) == -0.25f);
  CHECK(inner_sphere{{1, 2, 3}, 0.5f}.normal({1, 2, 3}) == vec3{0, 0, 0});
}

TEST_CASE("The distance to an ordinary triangle is right") {
  static_assert(clearance::explain_primitive<triangle>());
  dice d(2);
  verdict v;
  for (const double half : {1.0, 1000.0})
    for (const double edge : {1e-3, 0.1, 10.0})
      for (int k = 0; k < 15; ++k) {
        const triangle t = d.face(half, edge);
        for (const vec3 q : around(d, t)) {
          check(t, q, v);
          if (const real away = t.distance(q); half == 1 && away > 0.01 * size(t))
            v.require(!t.may_reach(q, 0.99f * away), "not ruled out at ", q, ", though", away, " away");
        }
      }
}

TEST_CASE("The distance to needles and slivers is right, down to aspects of 1e-9") {
  dice d(3);
  verdict v;
  for (const double aspect : {1e-2, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9})
    for (int k = 0; k < 6; ++k) {
      const vec3 a = d.point(k % 2 ? 1 : 0.001), along = d.direction(),
                 thin = clearance::scaled(real(aspect), d.direction());
      const vec3 b = a + along;
      // A short edge (needle), an obtuse corner on the long edge (sliver), and one beyond its end.
      for (const vec3 c :
           {a + thin, clearance::fma(d.number(0.1, 0.9), along, a) + thin, clearance::fma(1.5f, along, a) + thin}) {
        for (const triangle& t : {triangle::from(a, b, c), triangle::from(c, a, b), triangle::from(b, a, c)})
          for (const vec3 q : around(d, t)) check(t, q, v);
      }
    }
}

TEST_CASE("However short a side is, a triangle may be as near as it is") {
  verdict v;
  for (int power = 50; power < 75; ++power) {  // at 63 its square is the least normal number
    const vec3 b{std::ldexp(1.0f, -power), 0, 0}, c{0, 1, 0};
    for (const triangle& t :
         {triangle::from({0, 0, 0}, b, c), triangle::from(c, {0, 0, 0}, b), triangle::from(b, c, {0, 0, 0})})
      for (const vec3 q : {vec3{0, 0, 0}, vec3{1, 0, 0}, vec3{0, -1, 0}, vec3{0, 0, 1}, vec3{-1, 0.5f, 0.5f}})
        v.require(t.may_reach(q, t.distance(q)), "a side of 2^-", power, ": ruled out at ", q);
  }
}

TEST_CASE("A triangle twice as large and far is twice as far, to the bit") {
  dice d(8);
  verdict v;
  for (int k = 0; k < 20000; ++k) {
    const vec3 a = d.point(1), along = d.direction(),
               thin = clearance::scaled(std::ldexp(1.0f, -int(d.below(24))), d.direction());
    const vec3 b = a + along, c = (k % 2 == 0 ? a : clearance::fma(d.number(0, 1), along, a)) + thin;
    // Mostly near a tip, and beyond it.
    const vec3 q = clearance::fma(std::ldexp(d.number(-1, 1), -int(d.below(20))), along, k % 3 == 0 ? a : b) +
                   clearance::scaled(std::ldexp(1.0f, -int(d.below(24))), d.direction());
    const real is = triangle::from(a, b, c).distance(q);
    for (const real s : {0x1p-10f, 0x1p12f}) {
      const auto by = [&](vec3 p) { return vec3{s * p.x, s * p.y, s * p.z}; };
      v.require(triangle::from(by(a), by(b), by(c)).distance(by(q)) == s * is, "by ", s, ": not ", is,
                " times that, at ", q);
    }
  }
}

TEST_CASE("A triangle without area is its edges") {
  dice d(4);
  verdict v;
  for (int k = 0; k < 15; ++k) {
    const vec3 a = d.point(1), b = d.point(1), middle = clearance::fma(0.5f, b - a, a);
    for (const triangle& t :
         {triangle::from(a, a, a), triangle::from(a, a, b), triangle::from(a, b, a), triangle::from(b, a, a),
          triangle::from(vec3{0, 0, 0}, vec3{1, 2, 3}, vec3{2, 4, 6}), triangle::from(a, b, middle)})
      for (const vec3 q : around(d, t)) check(t, q, v);
  }
  CHECK(triangle::from({1, 1, 1}, {1, 1, 1}, {1, 1, 1}).normal({1, 1, 1}) == vec3{0, 0, 0});
}

TEST_CASE("A way through a triangle touches it, however long it is") {
  dice d(6);
  std::size_t through = 0;
  verdict v;
  for (int k = 0; k < 2000; ++k) {
    const triangle t = triangle::from(d.point(0.5), d.point(0.5), d.point(0.5));
    const vec3 middle = clearance::fma(0.25f, t.b - t.a, clearance::fma(0.25f, t.c - t.a, t.a)),
               along = clearance::scaled(d.number(2, 16), d.direction());
    if (std::abs(dot(along, t.unit_normal)) < 0.2f * length(along)) continue;
    const clearance::capsule way{clearance::fma(-d.number(0, 0.2), along, middle), along, d.number(0, 0.1)};
    v.require(distance_to(t, way) == -way.radius, "a way of", length(along), "is", distance_to(t, way), "away");
    ++through;
  }
  CHECK(through > 1000);
}

TEST_CASE("On a triangle the distance is 0 and the normal the triangle's own") {
  const triangle t = triangle::from({0, 0, 0}, {2, 0, 0}, {0, 2, 0});
  CHECK(t.distance({0.5f, 0.5f, 0}) == 0);
  CHECK(t.normal({0.5f, 0.5f, 0}) == vec3{0, 0, 1});
  CHECK(t.normal({0.5f, 0.5f, -3}) == vec3{0, 0, -1});
  CHECK(t.nearest({0.5f, 0.5f, -3}) == vec3{0.5f, 0.5f, 0});
  CHECK(t.nearest({-3, -4, 0}) == vec3{0, 0, 0});
}

TEST_CASE("A share of a way is between its ends, and no transform is none at all") {
  for (const real t : {-2.0f, -0.0f, 0.0f, 0.25f, 1.0f, 1.5f, 3.0f})
    CHECK(clearance::clamp01(t) == std::clamp(t, 0.0f, 1.0f));
  CHECK(clearance::rigid_transform{}(vec3{1, 2, 3}) == vec3{1, 2, 3});
}

TEST_CASE("The ball around a triangle has its corners inside, and one on it") {
  dice d(6);
  verdict v;
  for (int k = 0; k < 200; ++k) {
    const triangle t = d.face(1, 1);
    const ball around = t.as_ball();
    const real most = std::max({length(t.a - around.center), length(t.b - around.center), length(t.c - around.center)});
    v.require(most <= around.radius && around.radius < most * 1.0001f + 1e-5f, "corners at ", most, " of ",
              around.radius);
    const vec3 off = scaled(3, around.center) - t.a - t.b - t.c;
    v.require(length(off) < 1e-5f, "its middle is elsewhere");
  }
}

TEST_CASE("The hull of a primitive's balls contains it") {
  dice d(5);
  verdict v;
  for (int k = 0; k < 200; ++k) {
    const triangle t = d.face(1, 1);
    const inner_sphere s = d.sphere(1, 0.01, 1);
    v.require(t.balls()[0].center == t.a && t.balls()[1].center == t.b && t.balls()[2].center == t.c, "corners");
    v.require(t.balls()[0].radius == 0 && t.balls()[1].radius == 0 && t.balls()[2].radius == 0, "radii");
    v.require(s.balls()[0].center == s.center && s.balls()[0].radius == s.radius, "sphere");
  }
}

}  // namespace primitives_test
