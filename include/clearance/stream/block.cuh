// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the threads of one block share: the bounds, the parts, the best candidates, and the pairs still to be looked at.

#include <clearance/search/root_test.hpp>
#include <clearance/stream/stream_args.hpp>

namespace clearance::stream {

inline constexpr int block_threads = 512;
inline constexpr int lanes = 8;  ///< Threads that share one pair: one a child of an 8-wide node.
inline constexpr std::uint32_t groups = block_threads / lanes;
inline constexpr std::uint32_t all_lanes = 0xffffffffu;

/// A point near a part: first in the cloud's frame, then in the part's.
struct pair {
  vec3 x;
  std::uint32_t point;
  std::uint32_t part;  ///< none: done with.
};

/// A pair against the children (or primitives) first .. first+count-1 of a node no nearer than `bound`.
struct pending {
  real bound;
  bvh_node node;
  std::uint32_t pair;
};

template <class T>
__device__ T fresh(const T& shared) {
  return *static_cast<const volatile T*>(&shared);
}

/// The least of the values of the lanes in `mask`, which all call it together.
__device__ inline std::uint32_t least_of(unsigned mask, std::uint32_t value) {
#if __CUDA_ARCH__ >= 800
  return __reduce_min_sync(mask, value);
#else
  std::uint32_t least = value;
  for (unsigned left = mask; left != 0; left &= left - 1) {
    const std::uint32_t other = __shfl_sync(mask, value, __ffs(int(left)) - 1);
    least = other < least ? other : least;
  }
  return least;
#endif
}

/// What a tree's depth-first stack may need: `build` sees to it.
inline constexpr std::uint32_t deepest_stack = 64;

/// `Each`: one bound a part, and every part's minimum; else one bound for all.
template <class PartView, bool Each>
struct block_memory {
  static constexpr std::uint32_t pair_capacity = 448, queue_capacity = 1024;
  static constexpr std::uint32_t slots = Each ? most_parts : 1;

  std::uint32_t bound[slots];  ///< ordered(): least of what this block and, at times, all blocks know.
  record best[slots];
  distance_key least[slots];  ///< The keys of `best`, or soon to be.
  std::uint32_t pairs;
  std::uint32_t children;  ///< Entries of the queue that roots were replaced with.
  std::uint32_t queued[2];  ///< Entries of the queue, by parity of the round.
  std::uint32_t dropped[drop_reasons];
  unsigned lock[slots];
  bool last, rigid;
  search::frame_facts frame;
  search::root_test near_cluster[most_parts / cluster];
  search::root_test near_part[most_parts];
  stream_part<PartView> parts[inline_parts];
  bvh_node top_nodes[inline_parts][lanes];  ///< The roots' children.
  typename PartView::hierarchy_type::volume_type top_volumes[inline_parts][lanes];
  pair pair_table[pair_capacity];
  pending queue[queue_capacity];

  static __device__ std::uint32_t slot(std::uint32_t part) { return Each ? part : 0; }
  __device__ real reach(std::uint32_t part) const { return from_ordered(fresh(bound[slot(part)])); }

  __device__ void lower(std::uint32_t part, real distance, frame_state& state) {
    const std::uint32_t u = ordered(distance);
    if (u < atomicMin(&bound[slot(part)], u)) atomicMin(&state.bound[slot(part)], u);
  }

  /// Keeps the better of `best` and `r`. Improvements are rare (a record process), so a lock costs nothing.
  __device__ void offer(const record& r) {
    record& kept = best[slot(r.part)];
    for (bool offered = false; !offered;) {
      if (atomicCAS(&lock[slot(r.part)], 0u, 1u) != 0) continue;
      __threadfence_block();
      if (before(r, kept)) kept = r;
      __threadfence_block();
      atomicExch(&lock[slot(r.part)], 0u);
      offered = true;
    }
  }
};

template <class PartView, bool Each>
__device__ const stream_part<PartView>& part(const frame_args<PartView>& a, const block_memory<PartView, Each>& s, std::uint32_t k) {
  if (k < inline_parts) return s.parts[k];
  return a.placed != nullptr ? a.placed->part[k] : a.more[k - inline_parts];
}

/// Parts go to shared memory: kernel arguments live behind the constant cache, a miss of which costs more than a round.
template <class PartView, bool Each>
__device__ void prepare(const frame_args<PartView>& a, block_memory<PartView, Each>& s) {
  using one = stream_part<PartView>;
  static_assert(sizeof(one) % sizeof(uint4) == 0);
  const std::uint32_t t = threadIdx.x, words = (a.parts < inline_parts ? a.parts : inline_parts) * std::uint32_t(sizeof(one) / sizeof(uint4));
  auto* const to = reinterpret_cast<uint4*>(s.parts);
  const auto copy = [&](const one* parts) {
    const auto* const from = reinterpret_cast<const uint4*>(parts);
    for (std::uint32_t i = t; i < words; i += block_threads) to[i] = from[i];
  };
  if (a.placed == nullptr)
    copy(a.part);
  else
    copy(a.placed->part);
  if (t < drop_reasons) s.dropped[t] = 0;
  if (t < block_memory<PartView, Each>::slots) s.bound[t] = a.first == 0 ? no_bound : fresh(a.state->bound[t]), s.best[t] = {}, s.least[t] = no_key, s.lock[t] = 0;
  if (t == block_threads - 1) {
    s.frame = a.placed == nullptr ? a.frame : a.placed->frame;
    s.rigid = a.placed == nullptr || a.placed->rigid;
    s.pairs = s.children = s.queued[0] = s.queued[1] = 0;
  }
}

/// The roots' children go there too: a round less through far memory for every point.
template <class PartView, bool Each>
class top_level {
 public:
  __device__ top_level(const frame_args<PartView>& a, const block_memory<PartView, Each>& s) {
    if (part_ >= inline_parts || part_ >= a.parts) return;
    const auto& body = s.parts[part_];
    exists_ = !body.root.is_leaf() && lane_ < body.root.count();
    if (!exists_) return;
    node_ = body.view.tree.nodes[body.root.first + lane_];
    volume_ = body.view.tree.volumes[body.root.first + lane_];
  }
  __device__ void put(block_memory<PartView, Each>& s) const {
    if (exists_) s.top_nodes[part_][lane_] = node_, s.top_volumes[part_][lane_] = volume_;
  }

 private:
  std::uint32_t part_ = threadIdx.x / lanes, lane_ = threadIdx.x % lanes;
  bool exists_ = false;
  bvh_node node_;
  typename PartView::hierarchy_type::volume_type volume_;
};

}  // namespace clearance::stream
