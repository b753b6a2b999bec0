// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Builds a tree over primitives, top down. You choose the volumes, how they fit, and how nodes are split.

#include <clearance/backends/host.hpp>
#include <clearance/bvh/bvh.hpp>
#include <clearance/bvh/split.hpp>
#include <clearance/concepts.hpp>

#include <ranges>
#include <stdexcept>
#include <string>

namespace clearance {

/// Fit rule: a node encloses the balls of all leaves below it. The tighter rule, and the default.
struct wrapped {
  template <class V>
  V operator()(std::span<const ball> leaves, std::span<const V>) const {
    return bounding_volume_traits<V>::fit(leaves);
  }
};

/// Fit rule: a node encloses its children's volumes, as in the first Inner Sphere Trees. Needs a volume with balls().
struct layered {
  template <class V>
  V operator()(std::span<const ball> leaves, std::span<const V> children) const {
    static_assert(
        requires(const V& v) { std::span<const ball>(bounding_volume_traits<V>::balls(v)); },
        "the layered fit needs a volume with balls(): a few balls whose convex hull contains it");
    if (children.empty()) return bounding_volume_traits<V>::fit(leaves);
    std::vector<ball> all;
    for (const V& child : children)
      for (const ball& b : bounding_volume_traits<V>::balls(child)) all.push_back(b);
    return bounding_volume_traits<V>::fit(all);
  }
};

struct build_options {
  std::uint32_t width = 8;      ///< Children per node: 2, 4 or 8.
  std::uint32_t leaf_size = 4;  ///< Most primitives in a leaf.
};

namespace detail {

/// Any split rule. A tree is arranged by one function for all of them, which is compiled once.
class any_split {
 public:
  template <class Split>
  explicit any_split(const Split& split)
      : split_(&split), call_([](const void* its, std::span<split_item> items) {
          return std::size_t((*static_cast<const Split*>(its))(items));
        }) {}

  std::size_t operator()(std::span<split_item> items) const { return call_(split_, items); }

 private:
  const void* split_;
  std::size_t (*call_)(const void*, std::span<split_item>);
};

/// Cuts `items` into at most `width` groups with a range each. It always cuts the largest group that is not yet a leaf.
inline std::vector<std::pair<std::uint32_t, std::uint32_t>> cut(std::span<split_item> items, std::uint32_t begin,
                                                                std::uint32_t end, const build_options& options,
                                                                const any_split& split) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> groups = {{begin, end}};
  while (groups.size() < options.width) {
    auto largest = groups.begin();
    for (auto g = groups.begin(); g != groups.end(); ++g)
      if (g->second - g->first > largest->second - largest->first) largest = g;
    const auto [b, e] = *largest;
    if (e - b <= options.leaf_size) break;
    const auto middle = b + std::uint32_t(split(items.subspan(b, e - b)));
    *largest = {b, middle};
    groups.insert(largest + 1, {middle, e});
  }
  return groups;
}

struct topology {
  std::vector<bvh_node> nodes;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> range;  ///< The items below each node.
  std::uint32_t depth = 0;
};

/// A node's children follow one another and come after it.
inline topology arrange(std::span<split_item> items, const build_options& options, const any_split& split) {
  topology t;
  std::vector<std::uint32_t> level = {0};
  t.nodes.resize(1);
  t.range.emplace_back(0, std::uint32_t(items.size()));
  for (std::uint32_t n = 0; n < t.nodes.size(); ++n) {
    const auto [begin, end] = t.range[n];
    if (end - begin <= options.leaf_size) {
      t.nodes[n] = {begin, (end - begin) | bvh_node::leaf_bit};
      continue;
    }
    const auto groups = cut(items, begin, end, options, split);
    t.nodes[n] = {std::uint32_t(t.nodes.size()), std::uint32_t(groups.size())};
    for (const auto& g : groups) {
      t.nodes.push_back({});
      t.range.push_back(g);
      level.push_back(level[n] + 1);
      t.depth = std::max(t.depth, level[n] + 1);
    }
  }
  return t;
}

}  // namespace detail

/// Builds a tree of volumes V over a contiguous range of primitives on the host, top down; deterministic. A stack of 64
/// entries suffices for it (`stack_need`). Throws std::invalid_argument if there is no primitive, one is not finite,
/// has a negative radius or contradicts itself, or an option is wrong. Returns a bvh<V, P>; `auto` gives a bad V its
/// message.
template <class V, std::ranges::contiguous_range R, class Fit = wrapped, class Split = surface_area_split,
          primitive P = std::ranges::range_value_t<R>>
auto build(const R& input, build_options options = {}, Fit fit = {}, Split split = {}) {
  static_assert(explain_bounding_volume<V>());
  const std::span<const P> primitives(input);
  if (primitives.empty()) throw std::invalid_argument("clearance::build: there are no primitives");
  if (options.width != 2 && options.width != 4 && options.width != 8)
    throw std::invalid_argument("clearance::build: width is " + std::to_string(options.width) +
                                ", but must be 2, 4 or 8");
  if (options.leaf_size == 0) throw std::invalid_argument("clearance::build: leaf_size is 0, but must be at least 1");

  std::vector<split_item> items(primitives.size());
  for (std::uint32_t id = 0; id < items.size(); ++id) {
    vec3 lower{infinity, infinity, infinity}, upper = -lower;
    for (const ball& b : primitives[id].balls()) {
      if (!is_finite(b.center) || !(b.radius >= 0) || !is_finite(b.radius))
        throw std::invalid_argument("clearance::build: primitive " + std::to_string(id) +
                                    " is not finite or has a negative radius");
      const vec3 r{b.radius, b.radius, b.radius};
      lower = splits::least(lower, b.center - r);
      upper = splits::most(upper, b.center + r);
    }
    if constexpr (requires { primitives[id].consistent(); })
      if (!primitives[id].consistent())
        throw std::invalid_argument("clearance::build: the members of primitive " + std::to_string(id) +
                                    " contradict one another (triangle::from gives a triangle its normal)");
    items[id] = {id, {lower.x, lower.y, lower.z}, {upper.x, upper.y, upper.z}};
  }
  const auto too_deep = [&](const detail::topology& t) { return t.depth * (options.width - 1) + 1 > 64; };
  auto shape = detail::arrange(items, options, detail::any_split(split));
  if (const median_split halves; too_deep(shape)) shape = detail::arrange(items, options, detail::any_split(halves));

  bvh<V, P> tree;
  std::vector<ball> balls;
  std::vector<std::uint32_t> first_ball = {0};
  for (const auto& item : items) {
    tree.ids.push_back(item.id);
    tree.primitives.push_back(primitives[item.id]);
    for (const ball& b : primitives[item.id].balls()) balls.push_back(b);
    first_ball.push_back(std::uint32_t(balls.size()));
  }
  tree.nodes = std::move(shape.nodes);
  tree.depth = shape.depth;
  tree.volumes.resize(tree.nodes.size());
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {  // children before their parents
    const auto [begin, end] = shape.range[n];
    const auto& node = tree.nodes[n];
    tree.width = std::max(tree.width, node.is_leaf() ? 1u : node.count());
    const auto children =
        node.is_leaf() ? std::span<const V>{} : std::span<const V>(tree.volumes).subspan(node.first, node.count());
    tree.volumes[n] =
        fit(std::span<const ball>(balls).subspan(first_ball[begin], first_ball[end] - first_ball[begin]), children);
  }
  return tree;
}

}  // namespace clearance
