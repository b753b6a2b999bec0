// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A warp of a device walks one tree for one point: for witnesses, and where many configurations are decided.

#include <clearance/backends/device.cuh>
#include <clearance/minimum/apart.hpp>
#include <clearance/minimum/resolve.hpp>
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
      if (lane / lanes < take) {
        top = pending[count - 1 - lane / lanes];
        size = tree.size(top);
      }
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

/// The traversal of a whole warp for a witness: all lanes call it alike. Afterwards only the lane with the nearest
/// primitive, of equals the lowest, has any.
template <hierarchy H>
class walk_by_warp {
 public:
  struct memory {  // bytes, because shared memory is not initialised
    alignas(typename H::node_type) std::byte pending[warp_walk<H>::most * sizeof(typename H::node_type)];
  };
  explicit CLEARANCE_HD walk_by_warp(memory& of_warp)
      : walk_{reinterpret_cast<typename H::node_type*>(of_warp.pending)} {}

  template <primitive P>
  CLEARANCE_HD void operator()(const H& tree, vec3 q, nearest_primitive<P>& best) const {
    // Inside a solid nothing bounds it: a leaf does.
    const real reach = best.reach() < infinity ? best.reach() : scan::descend(scan::plain_steps<H>{tree}, q);
    keep_nearest(tree, q, reach, best);
  }
  template <primitive P>
  CLEARANCE_HD void operator()(const H& tree, vec3, of_capsule<nearest_primitive<P>>& about) const {
    keep_nearest(tree, about.c, about.reach(), about.ask);
  }

 private:
  CLEARANCE_CALLS_ANYTHING
  template <class Element, primitive P>
  CLEARANCE_HD void keep_nearest(const H& tree, const Element& q, real reach, nearest_primitive<P>& best) const {
#if defined(__CUDA_ARCH__)
    walk_(tree, q, reach, best);
    const real least = from_ordered(scan::least_of(scan::all_lanes, ordered(best.reach())));
    const bool nearest = best.id != none && best.within == least;
    if (best.id != scan::least_of(scan::all_lanes, nearest ? best.id : none)) best.id = none;
#endif
  }

  warp_walk<H> walk_;
};

/// A warp for each number.
template <hierarchy H, class F>
__global__ void __launch_bounds__(128) apart_kernel(std::uint32_t n, const __grid_constant__ F body) {
  start_early();
  __shared__ typename walk_by_warp<H>::memory pending[4];
  const std::uint32_t warp = threadIdx.x / 32, i = blockIdx.x * 4 + warp;
  if (i < n) body(i, walk_by_warp<H>(pending[warp]));
}

template <>
struct apart<device> {
  template <class PartView, class F>
  static void each(const device& on, const model_view<PartView>& model, std::size_t n, const F& body) {
    scan::walk_of(on, model);  // it refuses a tree that is too deep
    if (n != 0)
      on.launch_early(apart_kernel<typename PartView::hierarchy_type, F>, unsigned((n + 3) / 4), 128, 0,
                      std::uint32_t(n), body);
  }
};

}  // namespace clearance::minimum
