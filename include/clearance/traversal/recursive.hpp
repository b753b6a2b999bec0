// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The simplest walk through a tree, by calls of itself.

#include <clearance/concepts.hpp>

namespace clearance {

/// Depth first on the call stack, children in stored order: the paper's Algorithm 4.
struct recursive {
  /// Upper bound of one level's bytes on a device's call stack. For the library's trees ptxas reports at most 344
  /// (triangles in boxes, points with radii, sm_75), and 208 with inner spheres. A primitive of your own may need more.
  static constexpr std::size_t bytes_a_level = 384;

  /// The cudaLimitStackSize that a launch needs, in bytes, with room for the kernel itself.
  static std::size_t device_stack(std::uint32_t depth) { return 512 + (depth + 1) * bytes_a_level; }

  template <hierarchy H, visitor Q>
  CLEARANCE_HD void operator()(const H& tree, vec3 p, Q& q) const {
    if (bound_for(q, tree.volume(tree.root()), p) <= q.reach()) visit(tree, tree.root(), p, q);
  }

 private:
  template <hierarchy H, visitor Q>
  CLEARANCE_HD static void visit(const H& tree, typename H::node_type n, vec3 p, Q& q) {
    if (tree.is_leaf(n)) return offer_leaf(tree, n, p, q);
    const std::uint32_t size = tree.size(n);
    for (std::uint32_t k = 0; k < size; ++k) {
      const auto c = tree.child(n, k);
      if (bound_for(q, tree.volume(c), p) <= q.reach()) visit(tree, c, p, q);
    }
  }
};

}  // namespace clearance
