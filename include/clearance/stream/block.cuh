// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the threads of one block share: the bounds, the parts, the best candidates, and the pairs still to be looked at.

#include <clearance/stream/stream_args.hpp>
#include <clearance/stream/threads.cuh>

#include <cuda_pipeline.h>

namespace clearance::stream {

/// A point near a part: first in the cloud's frame, then in the part's.
struct alignas(16) pair {
  vec3 x;
  std::uint32_t point;
};

/// A pair (and its part, 16 bits each) against the children or primitives of a node no nearer than `bound`.
struct alignas(16) pending {
  real bound;
  bvh_node node;
  std::uint32_t pair;
};

/// The answer, if a block's best is the best of all; but for the counts.
struct draft {
  position at, nearest;
  vec3 normal;
  std::uint32_t primitive, part;
  clearance::state state;
  real distance, lower, upper;
};

/// `Each`: one bound a part, and every part's minimum; else one bound for all.
template <class PartView, bool Each>
struct block_memory {
  using volume_type = typename PartView::hierarchy_type::volume_type;
  static constexpr std::uint32_t pair_capacity = 1024, stack_capacity = 3 * deepest_stack, given_capacity = 32 * warps;
  static constexpr std::uint32_t slots = Each ? most_parts : 1;
  /// 73 nodes (three levels) of each of eight sphere trees; as much as leaves room for two blocks on a processor of an H200.
  static constexpr std::uint32_t top_capacity = (Each ? 10000 : 14016) / (sizeof(bvh_node) + sizeof(volume_type));

  frame_head<PartView> head;
  std::uint32_t bound[slots];  ///< ordered(): least of what this block and, at times, all blocks know.
  std::uint32_t seed_of_warp[warps];
  record best[slots];
  typename PartView::hierarchy_type::primitive_type nearest;  ///< Of `best`, where all parts share a bound.
  distance_key least[slots];  ///< The keys of `best`, or soon to be.
  std::uint32_t pairs, given;
  std::uint32_t kept;  ///< Witnesses for the next frame.
  std::uint32_t dropped[drop_reasons];
  unsigned lock[slots];
  distance_key drafted;  ///< What `answer` is about.
  draft answer;
  bool last, rigid, shifted;
  vec3 origin;  ///< Is subtracted from points, if it is not 0 (`shifted`).
  search::root_test near_cluster[most_clusters], near_part[most_parts];
  search::root_ball cluster[most_clusters];
  alignas(16) bvh_node top_nodes[top_capacity];
  alignas(16) volume_type top_volumes[top_capacity];
  pair pair_table[pair_capacity];
  std::uint16_t part_of_pair[pair_capacity];
  pending stack[warps][stack_capacity];
  pending given_nodes[given_capacity];

  static __device__ std::uint32_t slot(std::uint32_t part) { return Each ? part : 0; }
  __device__ real reach(std::uint32_t part) const { return from_ordered(fresh(bound[slot(part)])); }

  __device__ void lower(std::uint32_t part, real distance) {
    const std::uint32_t u = ordered(distance);
    if (u < atomicMin(&bound[slot(part)], u)) atomicMin(&head.state->bound[slot(part)], u);
  }

  /// Keeps the better of `best` and `r`. Improvements are rare (a record process), so a lock costs nothing.
  template <class Primitive>
  __device__ void offer(const record& r, const Primitive& primitive) {
    record& kept = best[slot(r.part)];
    for (bool offered = false; !offered;) {
      if (atomicCAS(&lock[slot(r.part)], 0u, 1u) != 0) continue;
      __threadfence_block();
      if (before(r, kept)) {
        kept = r;
        if constexpr (!Each) nearest = primitive;
      }
      __threadfence_block();
      atomicExch(&lock[slot(r.part)], 0u);
      offered = true;
    }
  }
};

/// One part for one frame: behind `block_memory`, as many as there are.
template <class PartView>
struct alignas(16) block_part {
  frame_part place;
  PartView view;
};

/// Bytes of shared memory of a block.
template <class PartView, bool Each>
constexpr std::size_t memory_bytes(std::uint32_t parts) {
  static_assert(sizeof(block_memory<PartView, Each>) % 16 == 0);
  return sizeof(block_memory<PartView, Each>) + parts * sizeof(block_part<PartView>);
}

/// A block's shared memory. Functions that are not inlined ask for it themselves, so that they know what kind of memory it is.
template <class PartView, bool Each>
__device__ block_memory<PartView, Each>& memory_of_block() {
  extern __shared__ __align__(16) std::byte stream_memory[];
  return *reinterpret_cast<block_memory<PartView, Each>*>(stream_memory);
}

}  // namespace clearance::stream
