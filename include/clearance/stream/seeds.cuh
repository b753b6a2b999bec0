// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A bound before the first test. Any real pair of a point and a primitive is a valid one, so nothing can be lost.

#include <clearance/stream/reader.cuh>

namespace clearance::stream {

/// Last frame's minima and their neighbours, looked at anew: sixteen threads a minimum, or four where each part has one.
template <class PartView, bool Each>
class last_frame {
 public:
  /// Reads what there is; nothing waits for it yet.
  explicit __device__ last_frame(const frame_state& state) : w_(state.witness[threadIdx.x / each]), known_(state.witnesses) {}

  template <class Source>
  __device__ void seed(const frame_args<PartView>& a, const Source& source, block_memory<PartView, Each>& s) const {
    const std::uint32_t n = threadIdx.x % each, point = key_index(w_.key) - a.first + n - (n == 0 ? 0 : each / 2);
    if (threadIdx.x / each >= known_ || w_.part >= a.parts || w_.primitive == none || point >= a.points) return;
    const auto& body = part(a, s, w_.part);
    const sample p = source[point];
    const real d = body.view.tree.primitives[w_.primitive].distance(body.place.part_from_cloud(p.position - s.frame.origin));
    if (p.valid() && d < infinity) atomicMin(&s.bound[s.slot(w_.part)], ordered(d));
  }

 private:
  static constexpr std::uint32_t each = block_threads / (Each ? most_parts : 32);
  record w_;
  std::uint32_t known_;
};

/// Greedily to one leaf, eight lanes together, and the distance to what is there.
template <class PartView>
__device__ void descend(const PartView& view, bvh_node n, vec3 q, unsigned mine, std::uint32_t& bound) {
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
  if (d < infinity) atomicMin(&bound, ordered(d));
}

/// No last frame: eight lanes take the most promising of their points down the tree (each eight lanes another part, where
/// every part needs a bound), and all blocks wait a little for one another. Nothing depends on that wait but speed, so it
/// gives up rather than hang.
template <class PartView, bool Each>
__device__ void seed_cold(const frame_args<PartView>& a, const quad_points& p, block_memory<PartView, Each>& s) {
  // By power: the square of the distance to a ball's centre less the square of its radius. No root, and good enough.
  real least_power = infinity;
  std::uint32_t k_least = 0;
  int j_least = 0;
  const std::uint32_t first = Each ? (threadIdx.x / lanes + blockIdx.x) % a.parts : 0, end = Each ? first + 1 : a.parts;
  for (std::uint32_t k = first; k < end; ++k) {
    const ball around = part(a, s, k).place.around;
#pragma unroll
    for (int j = 0; j < quad; ++j) {
      const vec3 d = p.at[j] - around.center;
      const real power = fma(-around.radius, around.radius, dot(d, d));
      if (power < least_power) least_power = power, k_least = k, j_least = j;
    }
  }
  real least = least_power;
  for (int step = 1; step < lanes; step *= 2) least = min(least, __shfl_xor_sync(all_lanes, least, step));
  const unsigned mine = 0xffu << (threadIdx.x & 24);
  const unsigned winners = __ballot_sync(all_lanes, least_power == least && least < infinity) & mine;
  if (winners != 0) {
    const int from = __ffs(int(winners)) - 1;
    const vec3 own = j_least == 0 ? p.at[0] : j_least == 1 ? p.at[1] : j_least == 2 ? p.at[2] : p.at[3];
    k_least = __shfl_sync(mine, k_least, from);
    const vec3 x{__shfl_sync(mine, own.x, from), __shfl_sync(mine, own.y, from), __shfl_sync(mine, own.z, from)};
    const auto& body = part(a, s, k_least);
    descend(body.view, body.root, body.place.part_from_cloud(x), mine, s.bound[s.slot(k_least)]);
  }
  __syncthreads();
  const std::uint32_t bounds = Each ? a.parts : 1;
  for (std::uint32_t k = threadIdx.x; k < bounds; k += block_threads) atomicMin(&a.state->bound[k], s.bound[k]);
  __syncthreads();
  if (threadIdx.x == 0) {
    __threadfence();
    atomicAdd(&a.state->seeded, 1u);
    const long long start = clock64();
    while (fresh(a.state->seeded) < gridDim.x && clock64() - start < 20000) {
    }
  }
  __syncthreads();
  for (std::uint32_t k = threadIdx.x; k < bounds; k += block_threads) atomicMin(&s.bound[k], fresh(a.state->bound[k]));
}

}  // namespace clearance::stream
