// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Lets trees in arrays run on a device though they are too deep or wide for its quicker way.

#include <clearance/concepts.hpp>

namespace clearance {

/// Shows only the members of a hierarchy. It lets trees in arrays that are deeper or wider than `build` makes them run
/// on a device, whose quicker way to read arrays relies on those limits.
template <hierarchy H>
struct any_tree {
  using node_type = typename H::node_type;
  using volume_type = typename H::volume_type;
  using primitive_type = typename H::primitive_type;

  H tree;

  CLEARANCE_HD node_type root() const { return tree.root(); }
  CLEARANCE_HD bool is_leaf(node_type n) const { return tree.is_leaf(n); }
  CLEARANCE_HD std::uint32_t size(node_type n) const { return tree.size(n); }
  CLEARANCE_HD node_type child(node_type n, std::uint32_t k) const { return tree.child(n, k); }
  CLEARANCE_HD decltype(auto) volume(node_type n) const { return tree.volume(n); }
  CLEARANCE_HD decltype(auto) primitive(node_type n, std::uint32_t k) const { return tree.primitive(n, k); }
  CLEARANCE_HD std::uint32_t id(node_type n, std::uint32_t k) const { return tree.id(n, k); }
  CLEARANCE_HD std::uint32_t depth() const { return tree.depth(); }
  CLEARANCE_HD std::uint32_t width() const { return tree.width(); }
};
template <hierarchy H>
any_tree(H) -> any_tree<H>;

}  // namespace clearance
