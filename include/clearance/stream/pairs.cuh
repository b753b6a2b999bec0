// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The few points near a part, against the trees. Every warp walks with some of them: eight nodes at once, four lanes to a node's
// children, from a stack that is its own, and gives away what is too much for it, to be dealt to all warps when they are done.

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
    unsigned left = 0;
#pragma unroll
    for (int j = 0; j < quad; ++j) {
      unsigned its = those >> j & 0x11111111u;
      for (; its != 0 && slot < memory::pair_capacity; its &= its - 1, ++slot) {
        s.pair_table[slot] = {p.at[j], s.head.first + first + j};
        s.part_of_pair[slot] = std::uint16_t(first_part + (unsigned(__ffs(int(its))) - 1) / quad);
      }
      left |= its << j;
    }
    return left;
  }

  /// All pairs that were kept, to the end; `found` is how many there were, or more. The whole block calls it together.
  static __device__ void drain(std::uint32_t found) {
    memory& s = frame::here();
    if (found == 0) return;
    walk(found < memory::pair_capacity ? found : memory::pair_capacity);
    __syncthreads();
    if (threadIdx.x == 0) s.pairs = s.given = 0;  // a barrier comes before the next one is kept
  }

 private:
  static constexpr std::uint32_t mates = 4;             ///< Lanes that share a node: two children each.
  static constexpr std::uint32_t at_once = 32 / mates;  ///< Nodes that a warp looks at together.

  static __device__ std::uint32_t lane() { return threadIdx.x % mates; }
  static __device__ std::uint32_t group() { return threadIdx.x % 32 / mates; }

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
      s.offer({make_key(0, point), k, none, none}, s.nearest);
      any_within surface{frame::place(k).error + view.facts.tolerance};
      near_first{}(view.tree, q, surface);
      if (!surface.found) atomicAdd(&s.head.state->certain, 1ull);
      return true;
    }
    return false;
  }

  /// A pair's point into its part's frame; and onto the stack what is within reach below the root of that part's tree, or the
  /// root if it is a leaf, unless the pair ends here. Four lanes to a pair.
  static __device__ std::uint32_t admit(std::uint32_t i, bool live, pending* stack, std::uint32_t top) {
    memory& s = frame::here();
    const pair c = live ? s.pair_table[i] : pair{};
    const std::uint32_t part = live ? s.part_of_pair[i] : 0;
    live = live && s.near_part[part].passes(c.x);
    const vec3 q = frame::place(part).part_from_cloud(c.x);
    if constexpr (!requires { PartView::interior_type::empty; }) {
      const unsigned gone = __ballot_sync(all_lanes, live && lane() == 0 && inside(q, c.point, part)) >> group() * mates;
      live = live && (gone & 1) == 0;
    }
    __syncwarp();  // all have read the pair
    if (live && lane() == 0) s.pair_table[i].x = q;
    const bvh_node root = live ? frame::node(part, 0) : bvh_node{0, 0};
    const std::uint32_t pair_and_part = part << 16 | i;
    const real reach = s.reach(part);
    top = push({-infinity, root, pair_and_part}, root.is_leaf() && lane() == 0, stack, top);
    return push_children(root, root.is_leaf() ? 0 : root.count(), pair_and_part, q, reach, stack, top);
  }

  /// A warp's share of the pairs, then of what warps have given away: a far point can be about equally far from hundreds of
  /// nodes. It takes nodes from the end of its stack, and fewer as that fills, at last one, whose whole subtree then fits into
  /// what is kept free: so the stack cannot overflow.
  static __device__ void walk(std::uint32_t count) {
    memory& s = frame::here();
    const std::uint32_t warp = threadIdx.x / 32, bounds = Each ? s.head.parts : 1;
    pending* const stack = s.stack[warp];
    // What other blocks know is asked for some rounds before it is looked at: nobody waits for it.
    std::uint32_t elsewhere = threadIdx.x < bounds ? fresh(s.head.state->bound[threadIdx.x]) : no_bound;
    std::uint32_t top = 0, row = 0;
    bool shared = false;
#pragma unroll 1
    for (int round = 0;; ++round) {
#pragma unroll 1
      for (; row * warps < count && top < at_once; row += at_once) {
        // A point's pairs follow one another, and so do neighbours': from another warp on in each row.
        const std::uint32_t its = row + group(), i = its * warps + (its + warp) % warps;
        top = admit(i, i < count, stack, top);
      }
      if (top == 0) {
        if (shared) break;
        __syncthreads();
        shared = true;
        top = take_share(stack);
        continue;
      }
      if (round % 8 == 7 && threadIdx.x < bounds) {
        if (elsewhere < fresh(s.bound[threadIdx.x])) atomicMin(&s.bound[threadIdx.x], elsewhere);
        elsewhere = fresh(s.head.state->bound[threadIdx.x]);
      }
      constexpr std::uint32_t room = memory::stack_capacity - deepest_stack, growth = most_children - 1;
      static_assert(at_once - 1 + at_once * most_children <= room - at_once * growth);
      std::uint32_t taken = top < at_once ? top : at_once;
      if (top > room - at_once * growth) taken = top + 2 * growth <= room ? 2 : 1;
      __syncwarp();  // all that has been pushed is there
      const pending e = group() < taken ? stack[top - 1 - group()] : pending{infinity, {0, 0}, 0};
      __syncwarp();
      top = expand(e, stack, top - taken);
      if (!shared && top > 2 * at_once) top = give(stack, top);
    }
  }

  /// All but the first of a warp's nodes, if there is room for all; the stack's new size. If another warp is quicker, some are
  /// kept and given, and looked at twice. All lanes of a warp call it.
  static __device__ std::uint32_t give(const pending* stack, std::uint32_t top) {
    memory& s = frame::here();
    const std::uint32_t lane = threadIdx.x % 32, some = top - at_once;
    std::uint32_t at = memory::given_capacity;
    if (lane == 0 && fresh(s.given) + some <= memory::given_capacity) at = atomicAdd(&s.given, some);
    at = __shfl_sync(all_lanes, at, 0);
    __syncwarp();  // all that has been pushed is there
#pragma unroll 1
    for (std::uint32_t k = lane; k < some && at + k < memory::given_capacity; k += 32) s.given_nodes[at + k] = stack[at_once + k];
    return at + some <= memory::given_capacity ? at_once : top;
  }

  /// This warp's share of what all have given; the stack's size.
  static __device__ std::uint32_t take_share(pending* stack) {
    memory& s = frame::here();
    const std::uint32_t lane = threadIdx.x % 32, warp = threadIdx.x / 32, i = lane * warps + warp;
    const std::uint32_t given = s.given < memory::given_capacity ? s.given : memory::given_capacity;
    if (i < given) stack[lane] = s.given_nodes[i];
    return (given + warps - 1 - warp) / warps;
  }

  /// Inner children within reach go onto the stack, primitives are looked at. All lanes of a warp call it.
  static __device__ std::uint32_t expand(const pending& e, pending* stack, std::uint32_t top) {
    memory& s = frame::here();
    pair v{};
    if (e.node.count_and_kind != 0) v = s.pair_table[e.pair & 0xffff];  // else another warp may be writing there
    const real reach = s.reach(e.pair >> 16);
    const std::uint32_t count = e.bound <= reach ? e.node.count() : 0;
    const bool leaf = e.node.is_leaf();
    top = push_children(e.node, leaf ? 0 : count, e.pair, v.x, reach, stack, top);
    look(e.node.first, leaf ? count : 0, e.pair >> 16, v, reach);
    return top;
  }

  /// The first `count` children of an inner node, as far as they are within reach; the stack's new size.
  static __device__ std::uint32_t push_children(bvh_node node, std::uint32_t count, std::uint32_t pair_and_part, vec3 q, real reach,
                                                pending* stack, std::uint32_t top) {
    constexpr std::uint32_t each = most_children / mates;
    pending child[each];
    bool within[each];
#pragma unroll
    for (std::uint32_t j = 0; j < each; ++j) {
      const std::uint32_t part = pair_and_part >> 16, k = lane() + j * mates, n = node.first + k;
      child[j] = {infinity, {0, 0}, pair_and_part};
      if (k < count) child[j] = {traits::lower_bound(frame::volume(part, n), q), frame::node(part, n), pair_and_part};
      within[j] = k < count && child[j].bound <= reach;
    }
#pragma unroll
    for (std::uint32_t j = 0; j < each; ++j) top = push(child[j], within[j], stack, top);
    return top;
  }

  /// Those of a warp's lanes that have something to push do so at once; the stack's new size.
  static __device__ std::uint32_t push(const pending& e, bool mine, pending* stack, std::uint32_t top) {
    const unsigned those = __ballot_sync(all_lanes, mine);
    pending* const place = stack + top + __popc(those & ((1u << threadIdx.x % 32) - 1));
    if (mine) *place = e;
    return top + std::uint32_t(__popc(those));
  }

  /// The primitives of leaves. All lanes of a warp call it.
  static __device__ void look(std::uint32_t first, std::uint32_t count, std::uint32_t part, const pair& v, real reach) {
#pragma unroll 1
    for (std::uint32_t k = lane(); __any_sync(all_lanes, k < count); k += mates) {
      record r;
      typename hierarchy::primitive_type primitive;
      if (k < count) {
        const hierarchy& tree = frame::view(part).tree;
        const std::uint32_t id = far(tree.ids + first + k);
        primitive = far(tree.primitives + first + k);
        if (const real distance = primitive.distance(v.x); distance <= reach) r = {make_key(distance, v.point), part, id, first + k};
      }
      if (__any_sync(all_lanes, r.key != no_key)) best_of_block<Each>::take(r, primitive, frame::here());
    }
  }
};

}  // namespace clearance::stream
