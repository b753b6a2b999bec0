// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A foreign tree: binary, linked by pointers, one primitive per leaf, halved in the order of the input.

#include <clearance/concepts.hpp>

namespace testing {

template <class V, class P>
struct linked_node {
  V bounds;
  P item;
  std::uint32_t number;
  const linked_node *left, *right;  ///< Null in leaves.
};

/// The view that traversals see.
template <clearance::bounding_volume V, clearance::primitive P>
struct linked_view {
  using node_type = const linked_node<V, P>*;
  using volume_type = V;
  using primitive_type = P;

  node_type top;
  std::uint32_t levels;

  CLEARANCE_HD node_type root() const { return top; }
  CLEARANCE_HD bool is_leaf(node_type n) const { return n->left == nullptr; }
  CLEARANCE_HD std::uint32_t size(node_type n) const { return n->left == nullptr ? 1 : 2; }
  CLEARANCE_HD node_type child(node_type n, std::uint32_t k) const { return k == 0 ? n->left : n->right; }
  CLEARANCE_HD const V& volume(node_type n) const { return n->bounds; }
  CLEARANCE_HD const P& primitive(node_type n, std::uint32_t) const { return n->item; }
  CLEARANCE_HD std::uint32_t id(node_type n, std::uint32_t) const { return n->number; }
  CLEARANCE_HD std::uint32_t depth() const { return levels; }
  CLEARANCE_HD std::uint32_t width() const { return levels == 0 ? 1 : 2; }
};

/// Owns the nodes, in one array that may be copied elsewhere. `lopsided` splits off one primitive at a time, which
/// makes the tree as deep as possible.
template <clearance::bounding_volume V, clearance::primitive P>
class linked_tree {
 public:
  using node = linked_node<V, P>;

  explicit linked_tree(const std::vector<P>& primitives, bool lopsided = false) : nodes_(2 * primitives.size() - 1) {
    used_ = 1;
    fill(0, primitives, 0, std::uint32_t(primitives.size()), lopsided, 0);
  }
  linked_view<V, P> view() const { return {nodes_.data(), depth_}; }

  /// The nodes with pointers as they must be at address `base`.
  std::vector<node> placed_at(const node* base) const {
    std::vector<node> moved = nodes_;
    for (node& n : moved)
      if (n.left != nullptr) n.left = base + (n.left - nodes_.data()), n.right = base + (n.right - nodes_.data());
    return moved;
  }

 private:
  void fill(std::size_t at, const std::vector<P>& primitives, std::uint32_t begin, std::uint32_t end, bool lopsided,
            std::uint32_t level) {
    depth_ = std::max(depth_, level);
    std::vector<clearance::ball> balls;
    for (std::uint32_t k = begin; k < end; ++k)
      for (const auto& b : primitives[k].balls()) balls.push_back(b);
    nodes_[at] = {clearance::bounding_volume_traits<V>::fit(balls), primitives[begin], begin, nullptr, nullptr};
    if (end - begin == 1) return;
    const std::uint32_t middle = lopsided ? begin + 1 : (begin + end) / 2;
    const std::size_t left = used_, right = used_ + 1;
    used_ += 2;
    fill(left, primitives, begin, middle, lopsided, level + 1);
    fill(right, primitives, middle, end, lopsided, level + 1);
    nodes_[at].left = &nodes_[left], nodes_[at].right = &nodes_[right];
  }

  std::vector<node> nodes_;
  std::size_t used_ = 0;
  std::uint32_t depth_ = 0;
};

}  // namespace testing
