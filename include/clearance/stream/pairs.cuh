// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The few points that survive the root tests, against the trees: a block's queue of (point, node) pairs, eight lanes to a
// pair, so that a survivor costs the depth of the tree in rounds and not the length of one thread's walk.

#include <clearance/query/any_within.hpp>
#include <clearance/stream/block.cuh>
#include <clearance/traversal/near_first.hpp>

namespace clearance::stream {

/// Is the point in the part's solid? Then its distance is 0, and there is nothing to look for in the tree.
template <class PartView>
__device__ bool inside(const frame_args<PartView>& a, block_memory<PartView>& s, vec3 q, std::uint32_t point, std::uint32_t k) {
  if constexpr (!requires { PartView::interior_type::empty; }) {
    const auto& body = part(a, s, k);
    if (s.best_key() <= make_key(0, point) && load_relaxed(&a.state->certain) != 0) return true;
    if (!body.view.interior.inside(q)) return false;
    s.lower(0, *a.state);
    s.offer({make_key(0, point), k, none, none});
    any_within surface{body.place.error + body.view.facts.tolerance};
    near_first{}(body.view.tree, q, surface);
    if (!surface.found) atomicAdd(&a.state->certain, 1ull);
    return true;
  }
  return false;
}

template <class PartView>
struct pair_search {
  using hierarchy = typename PartView::hierarchy_type;
  using traits = bounding_volume_traits<typename hierarchy::volume_type>;
  using memory = block_memory<PartView>;

  const frame_args<PartView>& a;
  memory& s;

  __device__ const stream_part<PartView>& part(std::uint32_t k) const { return stream::part(a, s, k); }

  /// False if there is no room before the next `drain`; then ask again after it.
  __device__ bool add(vec3 x, std::uint32_t point) {
    const std::uint32_t slot = atomicAdd(&s.candidates, 1u);
    if (slot >= memory::candidate_capacity) return false;
    s.candidate_table[slot] = {x, point};
    return true;
  }
  __device__ bool crowded() const { return fresh(s.candidates) > memory::candidate_capacity / 4; }

  /// All candidates against all parts, as many pairs at a time as there are threads. The whole block calls it.
  __device__ void drain() {
    __syncthreads();
    const std::uint32_t count = s.candidates < memory::candidate_capacity ? s.candidates : memory::candidate_capacity;
    const std::uint32_t pairs = count * a.parts;
    for (std::uint32_t base = 0; base < pairs; base += block_threads) {
      const std::uint32_t i = base + threadIdx.x;
      if (i < pairs) admit(s.candidate_table[i % count], i / count);
      walk();
    }
    if (threadIdx.x == 0) s.candidates = 0;
    __syncthreads();
  }

 private:
  /// One pair of a candidate and a part: into the queue, unless it ends here. No tree is touched yet.
  __device__ void admit(const candidate& c, std::uint32_t k) {
    if (!s.roots[k].passes(c.x)) return;
    const auto& body = part(k);
    const vec3 q = body.place.part_from_cloud(c.x);
    if (inside(a, s, q, c.point, k)) return;
    s.survivor_table[threadIdx.x] = {q, c.point, k};
    push({-infinity, body.root, threadIdx.x}, 0);
  }

  __device__ void push(const pending& e, int parity) { s.queue[atomicAdd(&s.queued[parity], 1u)] = e; }

  /// Takes pairs from the queue's end, one a group of eight lanes, until it is empty. It takes fewer as the queue fills, at
  /// last one, whose whole subtree then fits into what is kept free: so the queue cannot overflow.
  __device__ void walk() {
    const std::uint32_t group = threadIdx.x / lanes;
    for (int parity = 0;; parity ^= 1) {
      __syncthreads();
      const std::uint32_t queued = s.queued[parity];
      if (queued == 0) break;
      constexpr std::uint32_t room = memory::queue_capacity - deepest_stack;
      const std::uint32_t fits = queued < room ? (room - queued) / (lanes - 1) : 0;
      std::uint32_t taken = queued < groups ? queued : groups;
      taken = fits < taken ? (fits > 0 ? fits : 1) : taken;
      const bool busy = group < taken;
      const pending e = busy ? s.queue[queued - taken + group] : pending{};
      if (threadIdx.x == 0) s.queued[parity ^ 1] = queued - taken;
      if (threadIdx.x == block_threads - 1) atomicMin(&s.bound, fresh(a.state->bound));
      __syncthreads();
      if (busy && e.bound <= s.reach()) expand(e, parity ^ 1);
    }
    if (threadIdx.x == 0) s.queued[0] = s.queued[1] = 0;
    __syncthreads();
  }

  __device__ void expand(const pending& e, int parity) {
    const survivor v = s.survivor_table[e.survivor];
    const PartView& view = part(v.part).view;
    const hierarchy& tree = view.tree;
    const std::uint32_t lane = threadIdx.x & (lanes - 1);
    for (std::uint32_t k = lane; k < e.node.count(); k += lanes) {
      const std::uint32_t place = e.node.first + k;
      if (e.node.is_leaf()) {
        offer(v, view, place, tree.primitives[place].distance(v.q));
      } else {
        const bvh_node child = tree.nodes[place];
        const real lb = traits::lower_bound(tree.volumes[place], v.q);
        if (lb <= s.reach()) push({lb, child, e.survivor}, parity);
      }
    }
  }

  __device__ void offer(const survivor& v, const PartView& view, std::uint32_t place, real distance) {
    if (!(distance <= s.reach())) return;
    const distance_key key = make_key(distance, v.point);
    if (key > s.best_key()) return;
    s.lower(distance, *a.state);
    s.offer({key, v.part, view.tree.ids[place], place});
  }
};

}  // namespace clearance::stream
