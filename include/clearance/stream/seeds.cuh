// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A bound before the first test. Any real pair of a point and a primitive is a valid one, so nothing can be lost.

#include <clearance/stream/parts.cuh>
#include <clearance/stream/reader.cuh>

namespace clearance::stream {

/// Last frame's minima and their neighbours, looked at anew: sixteen threads a minimum, or four where each part has one.
/// Nothing of it needs shared memory to be ready.
template <class PartView, bool Each>
class last_frame {
 public:
  /// Reads what there is; nothing waits for it yet.
  explicit __device__ last_frame(const frame_args<PartView>& a) : w_(a.witnesses[slot()]), witnesses_(a.state->witnesses) {
    if (a.first != 0 && slot() < (Each ? a.parts : 1)) known_ = fresh(a.state->bound[slot()]);
  }

  /// Reads the points that those are about, once it is known which.
  template <class Source>
  __device__ void look(const frame_args<PartView>& a, const Source& source) {
    const std::uint32_t n = threadIdx.x % each, point = key_index(w_.r.key) - a.first + n - (n == 0 ? 0 : each / 2);
    const bool live = a.parts > w_.r.part && witnesses_ > slot() && w_.r.primitive != none && (!Each || w_.r.part == slot());
    if (live && point < a.points) p_ = source[point];
  }

  /// To the bounds of this block's warps, or of the parts.
  __device__ void seed(const frame_args<PartView>& a) const {
    auto& s = memory_of_block<PartView, Each>();
    const std::uint32_t n = threadIdx.x % each;
    std::uint32_t bound = known_;
    if (p_.valid()) {
      const real d = w_.primitive.distance(a.part()[w_.r.part].part_from_cloud(p_.position - a.facts().origin));
      if (d < infinity) bound = lower_of(bound, ordered(d));
    }
    if constexpr (Each) {
      for (int step = 1; step < int(each); step *= 2) bound = lower_of(bound, __shfl_xor_sync(all_lanes, bound, step));
      if (n == 0) s.bound[slot()] = bound;
    } else {
      bound = least_of(all_lanes, bound);
      if ((threadIdx.x & 31) == 0) s.seed_of_warp[threadIdx.x / 32] = bound;
    }
  }

  /// The bound of all parts, to all threads, after `seed` and a barrier; where each part has its own: `no_bound` if one has none.
  static __device__ std::uint32_t found(std::uint32_t parts) {
    auto& s = memory_of_block<PartView, Each>();
    const std::uint32_t lane = threadIdx.x & 31;
    if constexpr (Each) {
      bool all = true;
      for (std::uint32_t k = lane; k < parts; k += 32) all &= s.bound[k] != no_bound;
      return __all_sync(all_lanes, all) ? 0 : no_bound;
    } else {
      const std::uint32_t bound = least_of(all_lanes, lane < warps ? s.seed_of_warp[lane] : no_bound);
      if (threadIdx.x == 0) s.bound[0] = bound;
      return bound;
    }
  }

 private:
  static constexpr std::uint32_t each = block_threads / (Each ? most_parts : 32);
  static __device__ std::uint32_t slot() { return threadIdx.x / each; }
  typename frame_head<PartView>::witness_type w_;
  std::uint32_t witnesses_, known_ = no_bound;
  sample p_{{}, drop_reason::not_finite};
};

/// Greedily to one leaf of part k, eight lanes together; the ordered() distance to what is there. Warps stay together all
/// the way down, because groups that part ways wait for one another at every step.
template <class PartView, bool Each>
__device__ std::uint32_t descend(std::uint32_t k, vec3 q, bool live) {
  using traits = bounding_volume_traits<typename PartView::hierarchy_type::volume_type>;
  using parts = frame_parts<PartView, Each>;
  const std::uint32_t lane = threadIdx.x & (lanes - 1);
  bvh_node n = live ? parts::node(k, 0) : bvh_node{0, bvh_node::leaf_bit};
  while (__any_sync(all_lanes, !n.is_leaf())) {
    const bool exists = !n.is_leaf() && lane < n.count();
    const std::uint32_t c = n.first + (exists ? lane : 0);
    bvh_node child = n;
    real lb = infinity;
    if (exists) child = parts::node(k, c), lb = traits::lower_bound(parts::volume(k, c), q);
    real least = lb;
    for (int step = 1; step < lanes; step *= 2) least = min(least, __shfl_xor_sync(all_lanes, least, step));
    const unsigned winners = __ballot_sync(all_lanes, exists && lb == least) >> (threadIdx.x & 24) & 0xff;
    const int from = int(threadIdx.x & 24) + (winners != 0 ? __ffs(int(winners)) - 1 : 0);
    const std::uint32_t first = __shfl_sync(all_lanes, child.first, from), count = __shfl_sync(all_lanes, child.count_and_kind, from);
    if (!n.is_leaf()) n = winners != 0 ? bvh_node{first, count} : bvh_node{0, bvh_node::leaf_bit};
  }
  real d = infinity;
#pragma unroll 1
  for (std::uint32_t i = lane; i < n.count(); i += lanes) d = min(d, far(parts::view(k).tree.primitives + n.first + i).distance(q));
  return d < infinity ? ordered(d) : no_bound;
}

/// No last frame: eight lanes take the most promising of their points down the tree (each eight lanes another part, where
/// every part needs a bound), and all blocks wait a little for one another. Nothing depends on that wait but speed, so it
/// gives up rather than hang.
template <class PartView, bool Each>
__noinline__ __device__ void seed_cold(quad_points p) {
  using parts = frame_parts<PartView, Each>;
#pragma unroll
  for (int j = 0; j < quad; ++j)
    if ((p.reasons >> 8 * j & 0xff) != 0) p.at[j].x = not_a_number;  // is no nearest point
  auto& s = parts::here();
  const auto& a = s.head;
  // By power: the square of the distance to a ball's centre less the square of its radius. No root, and good enough. One
  // point a thread and all parts, or all four and a few parts: a handful of tests.
  real least_power = infinity;
  std::uint32_t k_least = 0;
  vec3 x = p.at[0];
  const std::uint32_t first = Each ? (threadIdx.x / lanes + blockIdx.x) % a.parts : 0, end = Each ? first + 1 : a.parts;
  const auto test = [&](std::uint32_t k, vec3 at) {
    const ball around = parts::place(k).root.around;
    const vec3 d = at - around.center;
    const real power = fma(-around.radius, around.radius, dot(d, d));
    if (power < least_power) least_power = power, k_least = k, x = at;
  };
  if (end - first < quad) {
    for (std::uint32_t k = first; k < end; ++k)
#pragma unroll
      for (int j = 0; j < quad; ++j) test(k, p.at[j]);
  } else {
    for (std::uint32_t k = first; k < end; ++k) test(k, p.at[0]);
  }
  real least = least_power;
  for (int step = 1; step < lanes; step *= 2) least = min(least, __shfl_xor_sync(all_lanes, least, step));
  const unsigned winners = __ballot_sync(all_lanes, least_power == least && least < infinity) >> (threadIdx.x & 24) & 0xff;
  const int from = int(threadIdx.x & 24) + (winners != 0 ? __ffs(int(winners)) - 1 : 0);
  k_least = __shfl_sync(all_lanes, k_least, from);
  x = {__shfl_sync(all_lanes, x.x, from), __shfl_sync(all_lanes, x.y, from), __shfl_sync(all_lanes, x.z, from)};
  std::uint32_t bound = descend<PartView, Each>(k_least, parts::place(k_least).part_from_cloud(x), winners != 0);
  if constexpr (!Each) bound = least_of(all_lanes, bound);
  if ((Each || (threadIdx.x & 31) == 0) && bound != no_bound) atomicMin(&s.bound[s.slot(k_least)], bound);
  __syncthreads();
  const std::uint32_t bounds = Each ? a.parts : 1;
  for (std::uint32_t k = threadIdx.x; k < bounds; k += block_threads) atomicMin(&a.state->bound[k], s.bound[k]);
  __syncthreads();
  if (threadIdx.x == 0) {
    count_in(a.state->seeded);
    const long long start = clock64();
    while (fresh(a.state->seeded) < gridDim.x && clock64() - start < 20000) {
    }
  }
  __syncthreads();
  for (std::uint32_t k = threadIdx.x; k < bounds; k += block_threads) atomicMin(&s.bound[k], fresh(a.state->bound[k]));
}

}  // namespace clearance::stream
