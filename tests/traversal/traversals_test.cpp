// SPDX-License-Identifier: BSD-3-Clause
#include "support/laws.hpp"
#include "support/linked_tree.hpp"
#include "support/volumes.hpp"

#include <clearance/bvh/build.hpp>
#include <clearance/bvh/flat_list.hpp>
#include <clearance/traversal/near_first.hpp>
#include <clearance/traversal/recursive.hpp>
#include <clearance/traversal/stack.hpp>
#include <clearance/visitor/any_within.hpp>
#include <clearance/visitor/nearest.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace traversals_test {

using namespace testing;

namespace {

/// Everything that is no farther than `margin`: its reach never shrinks, so each such primitive must be shown, once.
struct all_within {
  using result_type = all_within;

  real margin;
  std::uint64_t shown[4] = {};  ///< A bit an id.
  bool twice = false;

  CLEARANCE_HD real reach() const { return margin; }
  CLEARANCE_HD void offer(std::uint32_t id, real distance) {
    if (!(distance <= margin)) return;
    const std::uint64_t bit = std::uint64_t(1) << id % 64;
    twice = twice || (shown[id / 64] & bit) != 0;
    shown[id / 64] |= bit;
  }
  CLEARANCE_HD all_within result() const { return *this; }

  friend bool operator==(const all_within&, const all_within&) = default;
};

template <class P, class Q>
auto plain_loop(const std::vector<P>& primitives, vec3 p, Q q) {
  for (std::uint32_t id = 0; id < primitives.size(); ++id) q.offer(id, primitives[id].distance(p));
  return q.result();
}

template <class Walk, class H, class P>
void check_walk(const H& tree, const std::vector<P>& primitives, const std::vector<vec3>& points, verdict& v) {
  const Walk walk{};
  const auto ask = [&](vec3 p, auto q) {
    walk(tree, p, q);
    return q.result();
  };
  for (const vec3 p : points) {
    for (const real within : {infinity, 0.2f, 0.0f, -0.01f}) {
      const clearance::nearest q{.within = within};
      const auto got = ask(p, q), expected = plain_loop(primitives, p, q);
      v.require(same_bits(got.distance, expected.distance) && got.primitive == expected.primitive, "nearest is",
                got.primitive, " at", got.distance, " instead of", expected.primitive, " at", expected.distance);
      const clearance::any_within any{.margin = within};
      v.require(ask(p, any) == plain_loop(primitives, p, any), "any within", within);
      const all_within all{.margin = within};
      v.require(ask(p, all) == plain_loop(primitives, p, all), "all within", within);
    }
    // Exactly at reach: a tie must be shown.
    const real d = plain_loop(primitives, p, clearance::nearest{}).distance;
    v.require(ask(p, clearance::any_within{.margin = d}), "what is exactly at reach was pruned");
  }
}

template <class H, class P>
void check_walks(const H& tree, const std::vector<P>& primitives, const std::vector<vec3>& points, verdict& v) {
  check_walk<clearance::recursive>(tree, primitives, points, v);
  check_walk<clearance::stack>(tree, primitives, points, v);
  check_walk<clearance::near_first>(tree, primitives, points, v);
}

template <class P>
std::vector<std::vector<P>> scenes(dice& d) {
  std::vector<std::vector<P>> all = {random_primitives<P>(d, 1), random_primitives<P>(d, 7),
                                     random_primitives<P>(d, 150, 0.5, 0.2)};
  all.emplace_back(20, all[1][0]);
  all.push_back(all[1]);
  for (std::size_t k = all[1].size(); k-- > 0;) all.back().push_back(all[1][k]);
  return all;
}

template <class P>
std::vector<vec3> points_for(dice& d, const std::vector<P>& primitives) {
  auto points = d.points(12, 1.2);
  for (std::size_t k = 0; k < 6; ++k) {
    const ball b = primitives[k % primitives.size()].balls()[0];
    points.push_back(b.center);
    points.push_back(clearance::fma(b.radius, d.direction(), b.center));
  }
  points.push_back({1e6f, 0, 0});
  return points;
}

template <class V, class P>
void check_volume() {
  dice d(9);
  verdict v;
  for (const auto& primitives : scenes<P>(d)) {
    const auto points = points_for(d, primitives);
    for (const std::uint32_t width : {2, 4, 8})
      check_walks(clearance::build<V>(primitives, {.width = width, .leaf_size = width == 4 ? 1u : 4u}).view(),
                  primitives, points, v);
    check_walks(linked_tree<V, P>(primitives).view(), primitives, points, v);
  }
}

}  // namespace

TEST_CASE("Every traversal of a tree of spheres is the plain loop") {
  check_volume<clearance::sphere, inner_sphere>();
  check_volume<clearance::sphere, triangle>();
}
TEST_CASE("Every traversal of a tree of axis-aligned boxes is the plain loop") {
  check_volume<clearance::aabb, inner_sphere>();
  check_volume<clearance::aabb, triangle>();
}
TEST_CASE("Every traversal of a tree of oriented boxes is the plain loop") {
  check_volume<clearance::obb, inner_sphere>();
  check_volume<clearance::obb, triangle>();
}
TEST_CASE("Every traversal of a tree of one's own volumes is the plain loop") {
  check_volume<kdop14, triangle>();
  check_volume<Eigen::AlignedBox3f, inner_sphere>();
}

namespace {

/// As tight as the law allows: around one ball the bound is the distance itself, to the bit, so that ties are real.
struct tight_ball {
  clearance::sphere around;
  bool one;

  static tight_ball fit(std::span<const ball> balls) {
    if (balls.size() == 1) return {{balls[0].center, balls[0].radius}, true};
    return {clearance::sphere::fit(balls), false};
  }
  CLEARANCE_HD real lower_bound(vec3 q) const {
    return one ? inner_sphere{around.center, around.radius}.distance(q) : around.lower_bound(q);
  }
};

}  // namespace

TEST_CASE("What is bounded by exactly the reach is not pruned: ties are shown") {
  dice d(13);
  verdict v;
  for (auto primitives : scenes<inner_sphere>(d)) {
    const auto points = points_for(d, primitives);
    primitives.insert(primitives.end(), primitives.rbegin(), primitives.rend());
    if (primitives.size() > 256) primitives.resize(256);
    for (const std::uint32_t width : {2, 4, 8})
      check_walks(clearance::build<tight_ball>(primitives, {.width = width, .leaf_size = 1}).view(), primitives, points,
                  v);
    check_walks(linked_tree<tight_ball, inner_sphere>(primitives).view(), primitives, points, v);
  }
}

TEST_CASE("Every traversal of a flat list is the plain loop") {
  dice d(10);
  verdict v;
  for (const auto& primitives : scenes<inner_sphere>(d)) {
    std::vector<ball> balls;
    for (const auto& s : primitives) balls.push_back({s.center, s.radius});
    const clearance::flat_list<clearance::sphere, inner_sphere> list{clearance::sphere::fit(balls), primitives.data(),
                                                                     std::uint32_t(primitives.size())};
    check_walks(list, primitives, points_for(d, primitives), v);
  }
}

TEST_CASE("A point that is not a number is shown nothing") {
  dice d(11);
  const auto primitives = random_spheres(d, 50);
  const auto tree = clearance::build<clearance::sphere>(primitives);
  const auto boxes = clearance::build<clearance::aabb>(primitives);
  const auto count = [](auto walk, const auto& t) {
    clearance::nearest q;
    walk(t.view(), vec3{clearance::not_a_number, clearance::not_a_number, clearance::not_a_number}, q);
    return q.best;
  };
  CHECK(count(clearance::recursive{}, tree) == clearance::nearest::none);
  CHECK(count(clearance::stack{}, tree) == clearance::nearest::none);
  CHECK(count(clearance::near_first{}, tree) == clearance::nearest::none);
  CHECK(count(clearance::recursive{}, boxes) == clearance::nearest::none);
  CHECK(count(clearance::stack{}, boxes) == clearance::nearest::none);
  CHECK(count(clearance::near_first{}, boxes) == clearance::nearest::none);
}

TEST_CASE("The stack of 64 entries holds the deepest walk of a tree that needs exactly so many") {
  // 64 primitives cut off one at a time: depth 63, width 2, and each level leaves one child pending.
  std::vector<inner_sphere> line;
  for (int k = 0; k < 64; ++k) line.push_back({{real(k), 0, 0}, 0.25f});
  const linked_tree<clearance::sphere, inner_sphere> tree(line, true);
  REQUIRE(clearance::stack_need(tree.view()) == 64);
  verdict v;
  check_walks(tree.view(), line, {{0, 1, 0}, {63, 1, 0}, {31, 0, 0}, {-5, 0, 0}, {100, 0, 0}}, v);
}

TEST_CASE("Near first tests fewer primitives than stored order") {
  struct counting {
    using result_type = int;
    real best = infinity;
    int offers = 0;
    CLEARANCE_HD real reach() const { return best; }
    CLEARANCE_HD void offer(std::uint32_t, real distance) { ++offers, best = clearance::min(best, distance); }
    CLEARANCE_HD int result() const { return offers; }
  };
  dice d(12);
  const auto primitives = random_spheres(d, 2000, 1, 0.02);
  const auto tree = clearance::build<clearance::sphere>(primitives);
  int ordered = 0, nearest_first = 0;
  for (const vec3 p : d.points(100, 2)) {
    counting a, b;
    clearance::stack{}(tree.view(), p, a);
    clearance::near_first{}(tree.view(), p, b);
    ordered += a.offers, nearest_first += b.offers;
  }
  CHECK(nearest_first < ordered);
  CHECK(nearest_first < 100 * 100);
}

}  // namespace traversals_test
