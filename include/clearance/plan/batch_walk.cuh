// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/minimum/witness.hpp>
#include <clearance/scan/descend.hpp>
#include <clearance/scan/threads.cuh>

namespace clearance::minimum {

/// A warp walks one tree for one point: eight lanes open a node, and a leaf's primitives are dealt out among them. Each
/// lane has its own visitor.
template <hierarchy H>
struct warp_walk {
  using node_type = typename H::node_type;
  static constexpr std::uint32_t lanes = 8, nodes = 4;
  /// With more than `many` nodes pending, nodes are opened one after another. So the most that can be pending is
  /// `many`, plus what four nodes make, plus the 64 entries that check_stack allows.
  static constexpr std::uint32_t many = 32, most = many + nodes * lanes + 64;

  node_type* pending;  ///< This warp's memory, for `most` nodes.

  /// Shows the lanes' visitors together each primitive that is no farther than `reach`, or any visitor's.
  CLEARANCE_CALLS_ANYTHING
  template <class Element, visitor Q>
  CLEARANCE_HD void operator()(const H& tree, const Element& q, real reach, Q& ask) const {
#if defined(__CUDA_ARCH__)
    const std::uint32_t lane = threadIdx.x % 32, at_once = tree.width() <= lanes ? nodes : 1;
    if (!(scan::bound_of(tree.volume(tree.root()), q, reach) <= reach)) return;
    if (lane == 0) pending[0] = tree.root();
    __syncwarp();
    for (std::uint32_t count = 1; count > 0; __syncwarp()) {
      const std::uint32_t take = count > many ? 1 : scan::lower_of(at_once, count);
      node_type top{};
      std::uint32_t size = 0;
      if (lane / lanes < take) top = pending[count - 1 - lane / lanes], size = tree.size(top);
      count -= take;
      __syncwarp();
      const bool leaf = size != 0 && tree.is_leaf(top);
      for (std::uint32_t j = lane % lanes; __any_sync(scan::all_lanes, j < size); j += lanes) {
        bool near = false;
        node_type child{};
        if (j < size && leaf) {
          scan::offer_for(tree.id(top, j), tree.primitive(top, j), q, ask);
        } else if (j < size) {
          child = tree.child(top, j);
          near = scan::bound_of(tree.volume(child), q, reach) <= reach;
        }
        const unsigned those = __ballot_sync(scan::all_lanes, near);
        if (near) pending[count + __popc(those & ((1u << lane) - 1))] = child;
        count += std::uint32_t(__popc(those));
      }
      reach = min(reach, from_ordered(scan::least_of(scan::all_lanes, ordered(ask.reach()))));
    }
#endif
  }
};

/// A warp walks one tree for a witness. Afterwards only the lane with the nearest primitive, of equals the lowest, has
/// any.
template <hierarchy H>
struct walk_by_warp {
  warp_walk<H> walk;

  CLEARANCE_CALLS_ANYTHING
  template <primitive P>
  CLEARANCE_HD void operator()(const H& tree, vec3 q, nearest_primitive<P>& best) const {
#if defined(__CUDA_ARCH__)
    real reach = best.reach();
    if (!(reach < infinity))
      reach = scan::descend(scan::plain_steps<H>{tree}, q);  // inside a solid: a leaf gives a bound
    walk(tree, q, reach, best);
    const real least = from_ordered(scan::least_of(scan::all_lanes, ordered(best.reach())));
    const bool nearest = best.id != none && best.within == least;
    if (best.id != scan::least_of(scan::all_lanes, nearest ? best.id : none)) best.id = none;
#endif
  }
};

}  // namespace clearance::minimum
