// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/scan/parts.cuh>
#include <clearance/traversal/near_first.hpp>

namespace clearance::scan {

/// One thread walks a tree by itself. For too deep a tree the block has a stack in memory, for one thread at a time.
template <class Tally>
struct walk_alone {
  template <hierarchy H, visitor Q>
  __device__ void operator()(const H& tree, vec3 p, Q& q) const {
    auto& s = memory_of_block<Tally>();
    if constexpr (!node_of<H>::any_size) return near_first{}(tree, p, q);
    if (s.head.overflow == nullptr) return near_first{}(tree, p, q);
    using entry = near_first::entry_of<H>;
    static_assert(sizeof(entry) <= sizeof(typename Tally::block::pending_type));
    auto* const own = reinterpret_cast<typename Tally::block::pending_type*>(s.head.overflow) +
                      std::size_t(gridDim.x * warps + blockIdx.x) * s.head.overflow_room;
    for (bool done = false; !done;) {
      if (atomicCAS(&s.overflow_lock, 0u, 1u) != 0) continue;
      __threadfence_block();
      near_first::walk(tree, p, q, reinterpret_cast<entry*>(own));
      __threadfence_block();
      atomicExch(&s.overflow_lock, 0u);
      done = true;
    }
  }
};

}  // namespace clearance::scan
