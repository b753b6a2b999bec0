// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A rigid part of a robot: its tree, its inside, and how far they may be from the true solid.

#include <clearance/bvh/bvh.hpp>

#include <cmath>
#include <stdexcept>
#include <string>

namespace clearance {

/// What the bracket needs to know about a part. Metres, in the part's frame.
struct part_facts {
  vec3 center = {0, 0, 0};  ///< A ball around every primitive.
  real radius = infinity;
  real gap = 0;        ///< The solid's largest distance to the primitives, certified. Infinite: no certificate.
  real tolerance = 0;  ///< How far the solid may differ from the true surface, either way (tessellation).

  friend bool operator==(const part_facts&, const part_facts&) = default;
};

/// Throws std::invalid_argument unless `metres` is a length from 0 to infinity: others would make points free that are
/// not.
inline void check_length(double metres, const std::string& what) {
  if (!(metres >= 0))
    throw std::invalid_argument("clearance: " + what + " is " + std::to_string(metres) + " m, which must be 0 or more");
}
namespace detail {

[[gnu::noinline, gnu::cold]] inline void refuse_facts(const part_facts& facts, std::int64_t number) {
  const std::string of = number < 0 ? " of a part" : " of part " + std::to_string(number);
  check_length(facts.gap, "the gap" + of);
  check_length(facts.tolerance, "the tolerance" + of);
  check_length(facts.radius, "the radius" + of);
  if (!is_finite(facts.center)) throw std::invalid_argument("clearance: the centre" + of + " is not finite");
}

}  // namespace detail

/// Checks a part's facts; the only rule for them. Throws std::invalid_argument. `number` names the part in the message.
inline void check(const part_facts& facts, std::int64_t number = -1) {
  const bool lengths = facts.gap >= 0 && facts.tolerance >= 0 && facts.radius >= 0;
  if (!lengths || !is_finite(facts.center)) detail::refuse_facts(facts, number);
}

/// For primitives that know their own inside: no solid is asked.
struct no_interior {
  CLEARANCE_HD bool inside(vec3) const { return false; }
};

/// One rigid body as a kernel sees it: a tree, the test for points inside a solid (or none), and the facts.
template <hierarchy H, interior Interior = no_interior>
struct part_view {
  using hierarchy_type = H;
  using interior_type = Interior;

  H tree;
  Interior interior;
  part_facts facts;
};

/// A ball around all balls, in double and rounded up. Small, but not the smallest.
inline ball enclosing_ball(std::span<const ball> balls) {
  double lo[3] = {infinity, infinity, infinity}, hi[3] = {-infinity, -infinity, -infinity};
  for (const ball& b : balls) {
    const double c[3] = {b.center.x, b.center.y, b.center.z};
    for (int k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], c[k] - b.radius);
      hi[k] = std::max(hi[k], c[k] + b.radius);
    }
  }
  const vec3 center{to_float((lo[0] + hi[0]) / 2), to_float((lo[1] + hi[1]) / 2), to_float((lo[2] + hi[2]) / 2)};
  double radius = 0;
  for (const ball& b : balls) {
    const double d[3] = {double(b.center.x) - center.x, double(b.center.y) - center.y, double(b.center.z) - center.z};
    radius = std::max(radius, std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + b.radius);
  }
  return {center, rounded_up(radius * (1 + 2.0 * slack))};
}

/// A ball around primitives, in their part's frame.
template <primitive P>
ball enclosing_ball(std::span<const P> primitives) {
  std::vector<ball> balls;
  for (const P& p : primitives)
    for (const ball& b : p.balls()) balls.push_back(b);
  return enclosing_ball(std::span<const ball>(balls));
}

namespace detail {

/// An owner's view and its copy on another backend. An object without its own memory stands for itself.
template <class T>
auto view_or_self(const T& owner) {
  if constexpr (requires { owner.view(); })
    return owner.view();
  else
    return owner;
}
template <class T, class Other>
auto copy_or_self(const T& owner, const Other& other) {
  if constexpr (requires { owner.on(other); })
    return owner.on(other);
  else
    return owner;
}

}  // namespace detail

/// Owns what a part_view points to, in the memory of one backend. `Tree` is an owner with `view()`, such as bvh, or a
/// hierarchy itself: `part{tree, no_interior{}, facts}` makes a part from your own tree.
template <class Tree, class Interior = no_interior>
struct part {
  Tree tree;
  Interior interior;
  part_facts facts;

  auto view() const {
    const auto t = detail::view_or_self(tree);
    const auto i = detail::view_or_self(interior);
    return part_view<std::remove_const_t<decltype(t)>, std::remove_const_t<decltype(i)>>{t, i, facts};
  }

  /// A copy where `other` runs.
  template <backend Other>
  auto on(const Other& other) const {
    using tree_there = decltype(detail::copy_or_self(tree, other));
    using interior_there = decltype(detail::copy_or_self(interior, other));
    return part<tree_there, interior_there>{detail::copy_or_self(tree, other), detail::copy_or_self(interior, other),
                                            facts};
  }
};

template <class Tree, class Interior>
part(Tree, Interior, part_facts) -> part<Tree, Interior>;

namespace detail {

/// Throws std::invalid_argument unless walks stay in a tree's arrays, and stacks as large as it says suffice.
template <bounding_volume V, primitive P>
void check_tree(const bvh<V, P>& tree) {
  const auto require = [](bool holds, const char* otherwise) {
    if (!holds) throw std::invalid_argument(std::string("clearance: a tree ") + otherwise);
  };
  const std::size_t size = tree.nodes.size();
  require(size != 0 && tree.volumes.size() == size, "has another number of volumes than of nodes, or none");
  require(tree.primitives.size() == tree.ids.size(), "has another number of primitives than of their numbers");
  std::vector<std::uint32_t> level(size, 0);
  for (std::size_t n = 0; n < size; ++n) {
    const bvh_node& node = tree.nodes[n];
    const std::size_t end = std::size_t(node.first) + node.count();
    require(end <= (node.is_leaf() ? tree.primitives.size() : size), "has a node that reaches beyond its arrays");
    require(level[n] <= tree.depth && (node.is_leaf() || node.count() <= tree.width),
            "is deeper or wider than it says");
    if (node.is_leaf()) continue;
    require(node.first > n, "has a node that is not after its parent");
    for (std::size_t child = node.first; child < end; ++child) level[child] = level[n] + 1;
  }
}

}  // namespace detail

/// A part whose primitives are the whole solid, up to the certified `gap`. Metres. Throws std::invalid_argument if
/// `gap` or `tolerance` is negative or NaN, or if the tree's arrays contradict one another.
template <bounding_volume V, primitive P>
part<bvh<V, P>> make_part(bvh<V, P> tree, double gap = 0, double tolerance = 0) {
  detail::check_tree(tree);
  check_length(gap, "the gap of a part");
  check_length(tolerance, "the tolerance of a part");
  const ball around = enclosing_ball(std::span<const P>(tree.primitives));
  return {std::move(tree), {}, {around.center, around.radius, rounded_up(gap), rounded_up(tolerance)}};
}

}  // namespace clearance
