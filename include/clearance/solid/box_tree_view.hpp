// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/math.hpp>
#include <clearance/solid/vec3d.hpp>

#include <cstdint>

namespace clearance {

/// Two children of a node in a box tree.
struct box_pair {
  float low[2][3], high[2][3];
  std::uint32_t child[2];  ///< A node, or leaf_bit | first item << 3 | items - 1.

  static constexpr std::uint32_t leaf_bit = 1u << 31;
  CLEARANCE_HD double squared(int k, const vec3d& p) const {
    const double at[3] = {p.x, p.y, p.z};
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const double below = low[k][i] - at[i], above = at[i] - high[k][i];
      const double d = below > above ? below : above;
      if (d > 0) sum += d * d;
    }
    return sum;
  }
};

/// What searches of a box tree read, on host and device.
struct box_tree_view {
  const box_pair* nodes = nullptr;
  const std::uint32_t* order = nullptr;
  std::uint32_t items = 0, root = 0;

  static constexpr int stack_size = 96;

  /// Calls `visit(item, best)` for each item whose box is within `best` of p, near ones first. `visit` returns the new
  /// best, never above the old. Returns the last best; stops early once that is at most `enough`.
  CLEARANCE_CALLS_ANYTHING
  template <class F>
  CLEARANCE_HD double nearest(const vec3d& p, double best, F visit, double enough = -double(infinity)) const {
    if (items == 0) return best;
    struct {
      double distance;
      std::uint32_t child;
    } stack[stack_size];
    int top = 0;
    std::uint32_t at = root;
    for (;;) {
      if (at & box_pair::leaf_bit) {
        const std::uint32_t first = (at & ~box_pair::leaf_bit) >> 3, count = (at & 7) + 1;
        for (std::uint32_t i = first; i < first + count; ++i) best = visit(order[i], best);
        if (best <= enough) return best;
      } else {
        const box_pair& n = nodes[at];
        const double left = n.squared(0, p), right = n.squared(1, p), reach = best > 0 ? best * best : 0;
        const int near = right < left;
        const double nearer = near ? right : left, farther = near ? left : right;
        if (farther <= reach) stack[top++] = {farther, n.child[1 - near]};
        if (nearer <= reach) {
          at = n.child[near];
          continue;
        }
      }
      for (;;) {
        if (top == 0) return best;
        --top;
        if (stack[top].distance <= (best > 0 ? best * best : 0)) break;
      }
      at = stack[top].child;
    }
  }
};

}  // namespace clearance
