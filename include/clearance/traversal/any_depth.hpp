// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A walk on the host through trees of any depth.

#include <clearance/traversal/near_first.hpp>

#include <vector>

namespace clearance {

/// Nearest first on the host, for any depth and width. If 64 entries are not enough, each walk allocates a stack.
struct any_depth {
  std::uint64_t need;  ///< `stack_need` of the deepest tree.

  template <hierarchy H, visitor Q>
  CLEARANCE_HD void operator()(const H& tree, vec3 p, Q& q) const {
#if !defined(__CUDA_ARCH__)
    if (need > near_first::capacity) {
      std::vector<near_first::entry_of<H>> pending(need);
      return near_first::walk(tree, p, q, pending.data());
    }
#endif
    near_first{}(tree, p, q);
  }
};

}  // namespace clearance
