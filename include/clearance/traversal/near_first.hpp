// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A walk that looks at the nearest child first, so that most of the others need no look.

#include <clearance/concepts.hpp>

namespace clearance {

/// Depth first, nearest child first. The stack carries the children's bounds, so that a node is tested once.
template <int Capacity = 64>
struct basic_near_first {
  static constexpr std::uint32_t capacity = Capacity;

  template <hierarchy H>
  struct entry_of {
    real bound;
    typename H::node_type node;
  };

  template <hierarchy H, visitor Q>
  CLEARANCE_HD void operator()(const H& tree, vec3 p, Q& q) const {
    entry_of<H> pending[Capacity];
    walk(tree, p, q, pending);
  }

  /// The same walk with the caller's stack of `stack_need(tree)` entries.
  template <hierarchy H, visitor Q>
  CLEARANCE_HD static void walk(const H& tree, vec3 p, Q& q, entry_of<H>* pending) {
    using entry = entry_of<H>;
    std::uint32_t count = 0;
    pending[count++] = {bound_for(q, tree.volume(tree.root()), p), tree.root()};
    while (count > 0) {
      const entry top = pending[--count];
      if (!(top.bound <= q.reach())) continue;  // NaN prunes; ties survive
      if (tree.is_leaf(top.node)) {
        offer_leaf(tree, top.node, p, q);
        continue;
      }
      const std::uint32_t base = count, size = tree.size(top.node);
      const real reach = q.reach();
      for (std::uint32_t k = 0; k < size; ++k) {
        const auto c = tree.child(top.node, k);
        const entry e{bound_for(q, tree.volume(c), p), c};
        if (!(e.bound <= reach)) continue;
        push<H>(pending, base, count, e);
      }
    }
  }

  /// Pushes one more of a node's children, whose first is at `base`. The nearest stays on top.
  template <hierarchy H>
  CLEARANCE_HD static void push(entry_of<H>* pending, std::uint32_t base, std::uint32_t& count, const entry_of<H>& e) {
    std::uint32_t at = count++;
    for (; at > base && pending[at - 1].bound < e.bound; --at) pending[at] = pending[at - 1];
    pending[at] = e;
  }
};

using near_first = basic_near_first<>;

}  // namespace clearance
