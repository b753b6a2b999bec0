// SPDX-License-Identifier: BSD-3-Clause
// The least that a model of each concept must offer. If the library starts to need more, this stops compiling.
#include <clearance/bvh/build.hpp>
#include <clearance/traversal/near_first.hpp>
#include <clearance/traversal/recursive.hpp>
#include <clearance/traversal/stack.hpp>

#include <array>

namespace {

using clearance::ball, clearance::real, clearance::vec3;

struct least_primitive {
  CLEARANCE_HD real distance(vec3) const { return 0.5f; }
  CLEARANCE_HD vec3 nearest(vec3) const { return {}; }
  CLEARANCE_HD vec3 normal(vec3) const { return {}; }
  std::array<ball, 1> balls() const { return {}; }
};

struct least_volume {
  static least_volume fit(std::span<const ball>) { return {}; }
  CLEARANCE_HD real lower_bound(vec3) const { return 0; }
};

struct least_query {
  using result_type = unsigned;
  unsigned offers = 0;
  CLEARANCE_HD real reach() const { return 1; }
  CLEARANCE_HD void offer(std::uint32_t, real) { ++offers; }
  CLEARANCE_HD unsigned result() const { return offers; }
};

/// A root with two leaves of one primitive each; its nodes are no integers.
struct least_hierarchy {
  enum class node_type { root, left, right };
  using volume_type = least_volume;
  using primitive_type = least_primitive;
  CLEARANCE_HD node_type root() const { return node_type::root; }
  CLEARANCE_HD bool is_leaf(node_type n) const { return n != node_type::root; }
  CLEARANCE_HD std::uint32_t size(node_type n) const { return is_leaf(n) ? 1 : 2; }
  CLEARANCE_HD node_type child(node_type, std::uint32_t k) const { return k == 0 ? node_type::left : node_type::right; }
  CLEARANCE_HD volume_type volume(node_type) const { return {}; }
  CLEARANCE_HD primitive_type primitive(node_type, std::uint32_t) const { return {}; }
  CLEARANCE_HD std::uint32_t id(node_type n, std::uint32_t) const { return n == node_type::left ? 0 : 1; }
  CLEARANCE_HD std::uint32_t depth() const { return 1; }
  CLEARANCE_HD std::uint32_t width() const { return 2; }
};

static_assert(clearance::explain_primitive<least_primitive>());
static_assert(clearance::explain_bounding_volume<least_volume>());
static_assert(clearance::explain_visitor<least_query>());
static_assert(clearance::explain_hierarchy<least_hierarchy>());

template <class Traversal, class Tree>
unsigned offers(const Tree& tree) {
  least_query q;
  Traversal{}(tree, {}, q);
  return q.result();
}

template <class Tree>
bool walks_offer(const Tree& tree, unsigned expected) {
  return offers<clearance::recursive>(tree) == expected && offers<clearance::stack>(tree) == expected &&
         offers<clearance::near_first>(tree) == expected;
}

}  // namespace

int main() {
  const auto built = clearance::build<least_volume>(std::vector<least_primitive>(100));
  return walks_offer(least_hierarchy{}, 2) && walks_offer(built.view(), 100) ? 0 : 1;
}
