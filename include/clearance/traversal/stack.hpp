// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A walk through a tree without recursion, children in the order in which they are stored.

#include <clearance/concepts.hpp>

namespace clearance {

/// Depth first with a stack of its own, children in stored order: the paper's Algorithm 5.
template <int Capacity = 64>
struct basic_stack {
  static constexpr std::uint32_t capacity = Capacity;

  template <hierarchy H, visitor Q>
  CLEARANCE_HD void operator()(const H& tree, vec3 p, Q& q) const {
    typename H::node_type pending[Capacity];
    std::uint32_t count = 0;
    if (bound_for(q, tree.volume(tree.root()), p) <= q.reach()) pending[count++] = tree.root();
    while (count > 0) {
      const auto n = pending[--count];
      if (tree.is_leaf(n)) {
        offer_leaf(tree, n, p, q);
        continue;
      }
      for (std::uint32_t k = tree.size(n); k-- > 0;) {
        const auto c = tree.child(n, k);
        if (bound_for(q, tree.volume(c), p) <= q.reach()) pending[count++] = c;
      }
    }
  }
};

using stack = basic_stack<>;

}  // namespace clearance
