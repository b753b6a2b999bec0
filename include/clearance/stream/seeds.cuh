// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A bound before the first test. Any real pair of a point and a primitive is a valid one, so nothing can be lost.

#include <clearance/stream/block.cuh>
#include <clearance/stream/quads.cuh>

namespace clearance::stream {

/// Last frame's minima and their neighbours, looked at anew; false if this thread has found none.
template <class PartView, class Source>
__device__ bool seed_from_last_frame(const frame_args<PartView>& a, const Source& source, block_memory<PartView>& s) {
  const std::uint32_t t = threadIdx.x, each = block_threads / frame_state::kept;
  if (t >= a.state->witnesses * each) return false;
  const record w = a.state->witness[t / each];
  const std::uint32_t point = key_index(w.key) + t % each - (t % each == 0 ? 0 : each / 2);
  if (w.part >= a.parts || w.primitive == none || point >= a.points) return false;
  const sample p = source[point];
  if (!p.valid()) return false;
  const auto& body = part(a, s, w.part);
  const real d = body.view.tree.primitives[w.primitive].distance(body.place.part_from_cloud(p.position - a.origin));
  if (d < infinity) atomicMin(&s.bound, ordered(d));
  return d < infinity;
}

/// Greedily to one leaf, eight lanes together, and the distance to what is there.
template <class PartView>
__device__ void descend(const PartView& view, bvh_node n, vec3 q, unsigned mine, block_memory<PartView>& s) {
  const auto& tree = view.tree;
  using traits = bounding_volume_traits<typename PartView::hierarchy_type::volume_type>;
  const std::uint32_t lane = threadIdx.x & (lanes - 1);
  while (!n.is_leaf()) {
    const bool exists = lane < n.count();
    const std::uint32_t c = n.first + (exists ? lane : 0);
    const bvh_node child = tree.nodes[c];
    const real lb = exists ? traits::lower_bound(tree.volumes[c], q) : infinity;
    real least = lb;
    for (int step = 1; step < lanes; step *= 2) least = min(least, __shfl_xor_sync(mine, least, step));
    const unsigned winners = __ballot_sync(mine, lb == least && exists) & mine;
    if (winners == 0) return;
    const int from = __ffs(int(winners)) - 1;
    n = {__shfl_sync(mine, child.first, from), __shfl_sync(mine, child.count_and_kind, from)};
  }
  real d = infinity;
  for (std::uint32_t k = lane; k < n.count(); k += lanes) d = min(d, tree.primitives[n.first + k].distance(q));
  if (d < infinity) atomicMin(&s.bound, ordered(d));
}

/// No last frame: eight lanes take the most promising of their points down the tree, and all blocks wait a little for one
/// another. Nothing depends on that wait but speed, so it gives up rather than hang.
template <class PartView>
__device__ void seed_cold(const frame_args<PartView>& a, const quad_points& p, block_memory<PartView>& s) {
  real nearest = infinity;
  std::uint32_t k_nearest = 0;
  vec3 x{0, 0, 0};
  for (int j = 0; j < quad; ++j)
    for (std::uint32_t k = 0; k < a.parts; ++k) {
      const ball& around = part(a, s, k).place.around;
      const real lb = length(p.at[j] - around.center) - around.radius;
      if (lb < nearest) nearest = lb, k_nearest = k, x = p.at[j];
    }
  real least = nearest;
  for (int step = 1; step < lanes; step *= 2) least = min(least, __shfl_xor_sync(~0u, least, step));
  const unsigned mine = 0xffu << (threadIdx.x & 24);
  const unsigned winners = __ballot_sync(~0u, nearest == least && least < infinity) & mine;
  if (winners != 0) {
    const int from = __ffs(int(winners)) - 1;
    k_nearest = __shfl_sync(mine, k_nearest, from);
    x = {__shfl_sync(mine, x.x, from), __shfl_sync(mine, x.y, from), __shfl_sync(mine, x.z, from)};
    const auto& body = part(a, s, k_nearest);
    descend(body.view, body.root, body.place.part_from_cloud(x), mine, s);
  }
  __syncthreads();
  if (threadIdx.x == 0) {
    atomicMin(&a.state->bound, s.bound);
    __threadfence();
    atomicAdd(&a.state->seeded, 1u);
    const long long start = clock64();
    while (fresh(a.state->seeded) < gridDim.x && clock64() - start < 20000) {
    }
    atomicMin(&s.bound, fresh(a.state->bound));
  }
  __syncthreads();
}

}  // namespace clearance::stream
