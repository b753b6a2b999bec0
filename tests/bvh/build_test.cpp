// SPDX-License-Identifier: BSD-3-Clause
#include "support/laws.hpp"
#include "support/linked_tree.hpp"
#include "support/volumes.hpp"

#include <clearance/bvh/build.hpp>
#include <clearance/bvh/flat_list.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace build_test {

using namespace testing;
using clearance::build, clearance::build_options;

namespace {

/// Inputs that a builder may stumble over.
template <class P>
std::vector<std::vector<P>> inputs() {
  dice d(7);
  std::vector<std::vector<P>> all;
  for (const std::size_t n : {1, 2, 3, 4, 5, 8, 9, 33, 400}) all.push_back(random_primitives<P>(d, n));
  all.emplace_back(100, all[1][0]);  // all coincident
  all.push_back(all[6]);             // every one twice
  all.back().insert(all.back().end(), all[6].begin(), all[6].end());
  auto sizes = random_primitives<P>(d, 60, 1, 1e-4);
  for (const P& p : random_primitives<P>(d, 5, 100, 50)) sizes.push_back(p);
  all.push_back(sizes);
  return all;
}

std::vector<std::vector<inner_sphere>> more(std::vector<std::vector<inner_sphere>> all) {
  all.emplace_back();
  for (int k = 0; k < 200; ++k)
    all.back().push_back({{real(std::ldexp(1.0, k % 100 - 50)), 0, 0}, 0});  // on a line, doubling
  all.emplace_back();
  for (int k = 0; k < 64; ++k) all.back().push_back({{real(k % 4), real(k / 4 % 4), real(k / 16)}, 0.5f});  // a lattice
  return all;
}
std::vector<std::vector<triangle>> more(std::vector<std::vector<triangle>> all) { return all; }

template <class V, class P, class Fit, class Split = clearance::surface_area_split>
void check(Fit fit, Split split = {}) {
  verdict v;
  for (const auto& primitives : more(inputs<P>()))
    for (const std::uint32_t width : {2, 4, 8})
      for (const std::uint32_t leaf : {1, 4, 100}) {
        const auto tree = build<V>(primitives, {.width = width, .leaf_size = leaf}, fit, split);
        const auto view = tree.view();
        hierarchy_check(view, primitives, v);
        v.require(view.width() <= width, "wider than asked for");
        v.require(clearance::stack_need(view) <= 64, "stack_need is", clearance::stack_need(view));
        std::size_t children = 1;
        for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
          const auto& node = tree.nodes[n];
          if (node.is_leaf()) {
            v.require(node.count() <= leaf, "a leaf of", node.count());
          } else {
            v.require(node.first == children && node.first > n,
                      "children are not contiguous, in order, after their parent");
            v.require(node.count() >= 2, "a node with one child");
            children += node.count();
          }
        }
        v.require(children == tree.nodes.size(), "nodes that nobody's children are");
      }
}

}  // namespace

TEST_CASE("Trees of inner spheres hold every one once, enclosed by all their nodes") {
  check<clearance::sphere, inner_sphere>(clearance::wrapped{});
  check<clearance::sphere, inner_sphere>(clearance::layered{});
  check<clearance::aabb, inner_sphere>(clearance::wrapped{});
  check<clearance::aabb, inner_sphere>(clearance::layered{}, clearance::median_split{});
  check<clearance::obb, inner_sphere>(clearance::wrapped{});
  check<clearance::obb, inner_sphere>(clearance::layered{});
}

TEST_CASE("Every split rule gives a tree") {
  check<clearance::sphere, inner_sphere>(clearance::wrapped{}, clearance::median_split{});
  check<clearance::sphere, inner_sphere>(clearance::wrapped{}, clearance::principal_split{});
  check<clearance::sphere, inner_sphere>(clearance::wrapped{}, clearance::two_means_split{});
  check<clearance::aabb, triangle>(clearance::wrapped{}, clearance::two_means_split{});
  check<clearance::sphere, inner_sphere>(clearance::wrapped{}, clearance::neural_gas_split{});
}

TEST_CASE("Trees of triangles hold every one once, enclosed by all their nodes") {
  check<clearance::sphere, triangle>(clearance::layered{});
  check<clearance::aabb, triangle>(clearance::layered{});
  check<clearance::obb, triangle>(clearance::wrapped{}, clearance::median_split{});
  check<clearance::obb, triangle>(clearance::layered{});
}

TEST_CASE("Volumes that the library does not know make trees as its own do") {
  check<kdop14, triangle>(clearance::wrapped{});
  check<Eigen::AlignedBox3f, inner_sphere>(clearance::wrapped{});
}

TEST_CASE("A flat list and a linked binary tree are hierarchies") {
  verdict v;
  for (const auto& primitives : inputs<inner_sphere>()) {
    std::vector<ball> balls;
    for (const auto& s : primitives) balls.push_back({s.center, s.radius});
    hierarchy_check(
        clearance::flat_list<clearance::sphere, inner_sphere>{clearance::sphere::fit(balls), primitives.data(),
                                                              std::uint32_t(primitives.size())},
        primitives, v);
    hierarchy_check(linked_tree<clearance::aabb, inner_sphere>(primitives).view(), primitives, v);
    hierarchy_check(linked_tree<clearance::aabb, inner_sphere>(primitives, true).view(), primitives, v);
  }
}

TEST_CASE("Building twice gives the same tree") {
  dice d(8);
  const auto primitives = random_spheres(d, 300);
  const auto a = build<clearance::obb>(primitives), b = build<clearance::obb>(primitives);
  CHECK(a.ids == b.ids);
  CHECK(std::memcmp(a.volumes.data(), b.volumes.data(), a.volumes.size() * sizeof a.volumes[0]) == 0);
}

TEST_CASE("Builders refuse what is no tree, with the value in the message") {
  const std::vector<inner_sphere> one = {{{0, 0, 0}, 1}};
  const auto message = [](auto call) -> std::string {
    try {
      call();
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  const auto says = [&](auto call, const char* words) { return message(call).find(words) != std::string::npos; };
  CHECK(says([] { build<clearance::sphere>(std::vector<inner_sphere>{}); }, "no primitives"));
  for (const std::uint32_t width : {0u, 1u, 3u, 7u, 16u})
    CHECK(
        says([&] { build<clearance::sphere>(one, {.width = width}); }, ("width is " + std::to_string(width)).c_str()));
  CHECK(says([&] { build<clearance::sphere>(one, {.leaf_size = 0}); }, "leaf_size is 0"));
  const real bad[] = {clearance::not_a_number, infinity, -infinity, 1e30f};
  for (const real x : bad) {
    const std::vector<inner_sphere> balls = {{{0, 0, 0}, 1}, {{0, x, 0}, 1}}, radii = {{{0, 0, 0}, x}};
    CHECK(says([&] { build<clearance::sphere>(balls); }, "primitive 1 is not finite"));
    CHECK(says([&] { build<clearance::sphere>(radii); }, "primitive 0 is not finite"));
    const std::vector<triangle> faces = {triangle::from({0, 0, 0}, {1, 0, 0}, {0, 0, x})};
    CHECK(says([&] { build<clearance::obb>(faces); }, "primitive 0 is not finite"));
  }
  const std::vector<inner_sphere> negative = {{{0, 0, 0}, -1e-6f}};
  CHECK(says([&] { build<clearance::sphere>(negative); }, "negative radius"));
}

}  // namespace build_test
