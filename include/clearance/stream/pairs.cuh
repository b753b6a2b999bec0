// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The few points near a part, against the trees: a block's queue of (point, node) pairs, eight lanes to a pair, so that a
// point costs the depth of the tree in rounds and not the length of one thread's walk.

#include <clearance/query/any_within.hpp>
#include <clearance/stream/best.cuh>
#include <clearance/stream/reader.cuh>
#include <clearance/traversal/near_first.hpp>

namespace clearance::stream {

template <class PartView, bool Each>
struct pair_search : frame_parts<PartView, Each> {
  using frame = frame_parts<PartView, Each>;
  using hierarchy = typename PartView::hierarchy_type;
  using traits = bounding_volume_traits<typename hierarchy::volume_type>;
  using memory = block_memory<PartView, Each>;

  /// Keeps those of a lane's points for `drain` that are near a part of the cluster from `first_part` on, four bits a part;
  /// says which it has no room for. There is room for all of those that come first.
  static __device__ unsigned add(unsigned those, const quad_points& p, std::uint32_t first, std::uint32_t first_part) {
    static_assert(quad * cluster <= 32 && memory::pair_capacity >= quad * cluster);
    memory& s = frame::here();
    std::uint32_t slot = atomicAdd(&s.pairs, std::uint32_t(__popc(those)));
    for (; those != 0 && slot < memory::pair_capacity; those &= those - 1, ++slot) {
      const unsigned bit = unsigned(__ffs(int(those))) - 1, j = bit % quad;
      s.pair_table[slot] = {j < 2 ? (j == 0 ? p.at[0] : p.at[1]) : (j == 2 ? p.at[2] : p.at[3]), s.head.first + first + j, first_part + bit / quad};
    }
    return those;
  }

  /// All pairs that were kept, to the end; `found` is how many there were, or more. The whole block calls it together.
  static __device__ void drain(std::uint32_t found) {
    memory& s = frame::here();
    if (found == 0) return;
    walk(found < memory::pair_capacity ? found : memory::pair_capacity);
    if (threadIdx.x == 0) s.pairs = s.children = 0;
    __syncthreads();
  }

 private:
  static __device__ std::uint32_t lane() { return threadIdx.x & (lanes - 1); }
  static __device__ unsigned of_mates(unsigned ballot) { return ballot >> (threadIdx.x & 24) & 0xff; }

  /// Is the point in the part's solid? Then its distance is 0, and there is nothing to look for in the tree.
  static __device__ bool inside(vec3 q, std::uint32_t point, std::uint32_t k) {
    if constexpr (!requires { PartView::interior_type::empty; }) {
      memory& s = frame::here();
      const PartView& view = frame::view(k);
      // Not for the same point: another part may have been first there, and the lowest counts.
      if (fresh(s.least[s.slot(k)]) < make_key(0, point) && load_relaxed(&s.head.state->certain) != 0) return true;
      if (!view.interior.inside(q)) return false;
      s.lower(k, 0);
      atomicMin(&s.least[s.slot(k)], make_key(0, point));
      s.offer({make_key(0, point), k, none, none});
      any_within surface{frame::place(k).error + view.facts.tolerance};
      near_first{}(view.tree, q, surface);
      if (!surface.found) atomicAdd(&s.head.state->certain, 1ull);
      return true;
    }
    return false;
  }

  /// A pair goes into the queue, unless it ends here: those children of its root that are within reach, where they are at
  /// hand and the queue has room for them beside all other pairs (`few`: certainly). Eight lanes a pair; the whole warp
  /// calls it.
  static __device__ void admit(std::uint32_t i, bool live, bool few) {
    memory& s = frame::here();
    const pair c = live ? s.pair_table[i] : pair{{0, 0, 0}, 0, 0};
    live = live && s.near_part[c.part].passes(c.x);
    const vec3 q = frame::place(c.part).part_from_cloud(c.x);
    if constexpr (!requires { PartView::interior_type::empty; }) {
      const unsigned gone = of_mates(__ballot_sync(all_lanes, live && lane() == 0 && inside(q, c.point, c.part)));
      live = live && gone == 0;
    }
    __syncwarp();  // all have read the pair
    if (live && lane() == 0) s.pair_table[i].x = q;
    const bvh_node root = live ? frame::node(c.part, 0) : bvh_node{0, bvh_node::leaf_bit};
    bool opens = !root.is_leaf() && root.count() <= lanes && frame::at_hand(c.part, root.first + root.count());
    const bool exists = opens && lane() < root.count();
    const std::uint32_t child = exists ? c.part * s.head.top_stride + root.first + lane() : 0;
    const real lb = exists ? traits::lower_bound(s.top_volumes[child], q) : infinity;
    const bool within = exists && lb <= s.reach(c.part);
    if (!few) {
      const std::uint32_t n = std::uint32_t(__popc(of_mates(__ballot_sync(all_lanes, within))));
      if (lane() == 0 && n > 0) opens = opens && atomicAdd(&s.children, n) + n <= memory::queue_capacity - memory::pair_capacity - 4 * deepest_stack;
      opens = __shfl_sync(all_lanes, opens, int(threadIdx.x & 24));
    }
    push({lb, s.top_nodes[child], i}, within && opens, 0);
    push({-infinity, root, i}, live && lane() == 0 && !opens, 0);
  }

  /// Takes pairs from the queue's end, one a group of eight lanes, until it is empty. It takes fewer as the queue fills, at
  /// last one, whose whole subtree then fits into what is kept free: so the queue cannot overflow.
  static __device__ void walk(std::uint32_t count) {
    memory& s = frame::here();
    const std::uint32_t group = threadIdx.x / lanes, its = block_threads - 1 - threadIdx.x, bounds = Each ? s.head.parts : 1;
    // What other blocks know is asked for some rounds before it is looked at: nobody waits for it.
    std::uint32_t elsewhere = its < bounds ? fresh(s.head.state->bound[its]) : no_bound;
    best_of_block<Each> best(s);
    const bool few = count <= (memory::queue_capacity - 4 * deepest_stack) / lanes;
#pragma unroll 1
    for (std::uint32_t i = group; i - group % 4 < count; i += groups) admit(i, i < count, few);
    for (int round = 0, parity = 0;; ++round, parity ^= 1) {
      if (round % 4 == 3 && its < bounds) {
        if (elsewhere < fresh(s.bound[its])) atomicMin(&s.bound[its], elsewhere);
        elsewhere = fresh(s.head.state->bound[its]);
      }
      __syncthreads();
      const std::uint32_t queued = s.queued[parity];
      if (queued == 0) {
        if (threadIdx.x == 0) s.queued[parity ^ 1] = 0;
        break;
      }
      constexpr std::uint32_t room = memory::queue_capacity - deepest_stack;
      std::uint32_t taken = queued < groups ? queued : groups;
      if (queued > room - groups * (lanes - 1)) {
        const std::uint32_t fits = queued < room ? (room - queued) / (lanes - 1) : 0;
        taken = fits < taken ? (fits > 0 ? fits : 1) : taken;
      }
      const bool busy = group < taken;
      const pending e = busy ? s.queue[queued - taken + group] : pending{infinity, {0, 0}, 0};
      if (threadIdx.x == 0) s.queued[parity ^ 1] = queued - taken;
      __syncthreads();
      if (group - group % 4 < taken) {
        const record found = expand(e, parity ^ 1);
        if (__any_sync(all_lanes, e.node.is_leaf())) best.take(found, s);
      }
    }
    best.leave(s);
  }

  /// Inner children within reach go into the queue; of primitives the closest of this lane's is returned. The whole warp
  /// calls it.
  static __device__ record expand(const pending& e, int parity) {
    memory& s = frame::here();
    record best;
    const pair v = s.pair_table[e.pair];
    const real reach = s.reach(v.part);
    const std::uint32_t count = e.bound <= reach ? e.node.count() : 0;
#pragma unroll 1
    for (std::uint32_t k = lane(); __any_sync(all_lanes, k < count); k += lanes) {
      const std::uint32_t place = e.node.first + k;
      bvh_node child{0, 0};
      real lb = infinity;
      if (k < count) {
        if (e.node.is_leaf()) {
          const hierarchy& tree = frame::view(v.part).tree;
          const std::uint32_t id = far(tree.ids + place);
          const real distance = far(tree.primitives + place).distance(v.x);
          const record r{make_key(distance, v.point), v.part, id, place};
          if (distance <= reach && before(r, best)) best = r;
        } else {
          child = frame::node(v.part, place);
          lb = traits::lower_bound(frame::volume(v.part, place), v.x);
        }
      }
      push({lb, child, e.pair}, child.count_and_kind != 0 && lb <= reach, parity);
    }
    return best;
  }

  /// Those of a warp's lanes that have something to push do so at once. The whole warp calls it.
  static __device__ void push(const pending& e, bool mine, int parity) {
    memory& s = frame::here();
    const unsigned those = __ballot_sync(all_lanes, mine);
    if (those == 0) return;
    const std::uint32_t thread = threadIdx.x & 31;
    std::uint32_t at = 0;
    if (thread == 0) at = atomicAdd(&s.queued[parity], std::uint32_t(__popc(those)));
    at = __shfl_sync(all_lanes, at, 0) + std::uint32_t(__popc(those & ((1u << thread) - 1)));
    if (mine) s.queue[at] = e;
  }
};

}  // namespace clearance::stream
