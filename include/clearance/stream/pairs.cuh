// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The few points near a part, against the trees: a block's queue of (point, node) pairs, eight lanes to a pair, so that a
// point costs the depth of the tree in rounds and not the length of one thread's walk.

#include <clearance/query/any_within.hpp>
#include <clearance/stream/reader.cuh>
#include <clearance/traversal/near_first.hpp>

namespace clearance::stream {

/// Is the point in the part's solid? Then its distance is 0, and there is nothing to look for in the tree.
template <class PartView, bool Each>
__device__ bool inside(const frame_args<PartView>& a, block_memory<PartView, Each>& s, vec3 q, std::uint32_t point, std::uint32_t k) {
  if constexpr (!requires { PartView::interior_type::empty; }) {
    const auto& body = part(a, s, k);
    if (fresh(s.least[s.slot(k)]) <= make_key(0, point) && load_relaxed(&a.state->certain) != 0) return true;
    if (!body.view.interior.inside(q)) return false;
    s.lower(k, 0, *a.state);
    atomicMin(&s.least[s.slot(k)], make_key(0, point));
    s.offer({make_key(0, point), k, none, none});
    any_within surface{body.place.error + body.view.facts.tolerance};
    near_first{}(body.view.tree, q, surface);
    if (!surface.found) atomicAdd(&a.state->certain, 1ull);
    return true;
  }
  return false;
}

template <class PartView, bool Each>
struct pair_search {
  using hierarchy = typename PartView::hierarchy_type;
  using traits = bounding_volume_traits<typename hierarchy::volume_type>;
  using memory = block_memory<PartView, Each>;

  const frame_args<PartView>& a;
  memory& s;

  /// Keeps those of a lane's points for `drain` that are near a part of the cluster from `first_part` on, four bits a part;
  /// says which it has no room for. The whole warp calls it.
  __device__ unsigned add(unsigned those, const quad_points& p, std::uint32_t first, std::uint32_t first_part) const {
    static_assert(quad * cluster <= 32);
    const std::uint32_t lane = threadIdx.x & 31, mine = std::uint32_t(__popc(those));
    std::uint32_t sum = mine;
    for (std::uint32_t step = 1; step < 32; step *= 2)
      if (const std::uint32_t before = __shfl_up_sync(all_lanes, sum, step); lane >= step) sum += before;
    std::uint32_t slot = 0;
    if (lane == 31) slot = atomicAdd(&s.pairs, sum);
    slot = __shfl_sync(all_lanes, slot, 31) + sum - mine;
    for (; those != 0 && slot < memory::pair_capacity; those &= those - 1, ++slot) {
      const unsigned bit = unsigned(__ffs(int(those))) - 1, j = bit % quad;
      s.pair_table[slot] = {j < 2 ? (j == 0 ? p.at[0] : p.at[1]) : (j == 2 ? p.at[2] : p.at[3]), a.first + first + j, first_part + bit / quad};
    }
    unsigned missed = 0;  // what is left, by point
    for (; those != 0; those >>= quad) missed |= those & ((1u << quad) - 1);
    return missed;
  }
  __device__ bool crowded() const { return fresh(s.pairs) > memory::pair_capacity / 2; }

  /// All pairs that were kept, to the end. The whole block calls it.
  __device__ void drain() {
    __syncthreads();
    const std::uint32_t count = s.pairs < memory::pair_capacity ? s.pairs : memory::pair_capacity;
    for (std::uint32_t i = threadIdx.x; i < count; i += block_threads) admit(i);
    if (count > 0) walk();
    if (threadIdx.x == 0 && count > 0) s.pairs = s.children = 0;
    __syncthreads();
  }

 private:
  /// A pair goes into the queue, unless it ends here. No tree is touched yet.
  __device__ void admit(std::uint32_t i) {
    const pair c = s.pair_table[i];
    if (!s.near_part[c.part].passes(c.x)) return;
    const auto& body = part(a, s, c.part);
    const vec3 q = body.place.part_from_cloud(c.x);
    if (inside(a, s, q, c.point, c.part)) return;
    s.pair_table[i].x = q;
    if (c.part < inline_parts && !body.root.is_leaf() && body.root.count() <= lanes && push_children(i, c.part, q, body.root.count())) return;
    push({-infinity, body.root, i}, 0);
  }

  /// Instead of a root those of its children that are within reach, if the queue has room for them beside all other pairs.
  __device__ bool push_children(std::uint32_t i, std::uint32_t k, vec3 q, std::uint32_t count) {
    const real reach = s.reach(k);
    real lb[lanes];
    unsigned within = 0;
#pragma unroll
    for (std::uint32_t c = 0; c < lanes; ++c) {
      lb[c] = c < count ? traits::lower_bound(s.top_volumes[k][c], q) : infinity;
      within |= unsigned(c < count && lb[c] <= reach) << c;
    }
    const std::uint32_t n = std::uint32_t(__popc(within));
    if (n == 0) return true;
    if (atomicAdd(&s.children, n) + n > memory::queue_capacity - memory::pair_capacity - 4 * deepest_stack) return false;
    std::uint32_t at = atomicAdd(&s.queued[0], n);
#pragma unroll
    for (std::uint32_t c = 0; c < lanes; ++c)
      if (within >> c & 1) s.queue[at++] = {lb[c], s.top_nodes[k][c], i};
    return true;
  }

  __device__ void push(const pending& e, int parity) { s.queue[atomicAdd(&s.queued[parity], 1u)] = e; }

  /// Takes pairs from the queue's end, one a group of eight lanes, until it is empty. It takes fewer as the queue fills, at
  /// last one, whose whole subtree then fits into what is kept free: so the queue cannot overflow.
  __device__ void walk() {
    const std::uint32_t group = threadIdx.x / lanes;
    const bool messenger = threadIdx.x >= block_threads - memory::slots && threadIdx.x - (block_threads - memory::slots) < (Each ? a.parts : 1);
    const std::uint32_t its = threadIdx.x - (block_threads - memory::slots);
    std::uint32_t elsewhere = no_bound;  // what other blocks knew a round ago: nobody waits for it
    int parity = 0;
    for (;; parity ^= 1) {
      if (messenger && elsewhere < fresh(s.bound[its])) atomicMin(&s.bound[its], elsewhere);
      __syncthreads();
      if (messenger) elsewhere = fresh(a.state->bound[its]);
      const std::uint32_t queued = s.queued[parity];
      if (queued == 0) break;
      constexpr std::uint32_t room = memory::queue_capacity - deepest_stack;
      const std::uint32_t fits = queued < room ? (room - queued) / (lanes - 1) : 0;
      std::uint32_t taken = queued < groups ? queued : groups;
      taken = fits < taken ? (fits > 0 ? fits : 1) : taken;
      const bool busy = group < taken;
      const pending e = busy ? s.queue[queued - taken + group] : pending{infinity, {0, 0}, 0};
      if (threadIdx.x == 0) s.queued[parity ^ 1] = queued - taken;
      __syncthreads();
      offer(expand(e, parity ^ 1));
    }
    if (threadIdx.x == 0) s.queued[parity ^ 1] = 0;
    __syncthreads();
  }

  /// Inner children within reach go into the queue; of primitives the closest of this lane's is returned.
  __device__ record expand(const pending& e, int parity) {
    record best;
    const pair v = s.pair_table[e.pair];
    if (e.node.count() == 0 || !(e.bound <= s.reach(v.part))) return best;
    const hierarchy& tree = part(a, s, v.part).view.tree;
    const std::uint32_t lane = threadIdx.x & (lanes - 1);
    for (std::uint32_t k = lane; k < e.node.count(); k += lanes) {
      const std::uint32_t place = e.node.first + k;
      if (e.node.is_leaf()) {
        const real distance = tree.primitives[place].distance(v.x);
        if (!(distance <= s.reach(v.part))) continue;
        const record r{make_key(distance, v.point), v.part, tree.ids[place], place};
        if (before(r, best)) best = r;
      } else {
        const bvh_node child = tree.nodes[place];
        const real lb = traits::lower_bound(tree.volumes[place], v.x);
        if (lb <= s.reach(v.part)) push({lb, child, e.pair}, parity);
      }
    }
    return best;
  }

  /// The lanes that share a bound agree first, then the block by an atomic minimum: so few come to the lock. The whole warp
  /// calls it.
  __device__ void offer(const record& r) {
    const std::uint32_t mine = std::uint32_t(r.key >> 32);
    const std::uint32_t least = least_of(Each ? __match_any_sync(all_lanes, r.part) : all_lanes, mine);
    if (r.key == no_key || mine != least || r.key > atomicMin(&s.least[s.slot(r.part)], r.key)) return;
    s.lower(r.part, key_distance(r.key), *a.state);
    s.offer(r);
  }
};

}  // namespace clearance::stream
