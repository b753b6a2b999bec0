// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the threads of one block share: the bound, the parts, the best candidate, and the pairs still to be looked at.

#include <clearance/search/root_test.hpp>
#include <clearance/stream/stream_args.hpp>

namespace clearance::stream {

inline constexpr int block_threads = 512;
inline constexpr int lanes = 8;  ///< Threads that share one pair: one a child of an 8-wide node.
inline constexpr std::uint32_t groups = block_threads / lanes;
inline constexpr std::uint32_t most_parts = 128;

/// A point that survived some root test, in the cloud's frame.
struct candidate {
  vec3 x;
  std::uint32_t point;
};

/// A point that survived a part's root test, in that part's frame.
struct survivor {
  vec3 q;
  std::uint32_t point;
  std::uint32_t part;
};

/// A survivor against the children (or primitives) first .. first+count-1 of a node no nearer than `bound`.
struct pending {
  real bound;
  bvh_node node;
  std::uint32_t survivor;
};

template <class T>
__device__ T fresh(const T& shared) {
  return *static_cast<const volatile T*>(&shared);
}

template <class PartView>
struct block_memory {
  static constexpr std::uint32_t candidate_capacity = 640, queue_capacity = 1152;
  static constexpr std::uint32_t inline_parts = stream::inline_parts;

  std::uint32_t bound;  ///< ordered(): least of what this block and, at times, all blocks know.
  std::uint32_t candidates;
  std::uint32_t queued[2];  ///< Pairs in the queue, by parity of the round.
  std::uint32_t dropped[drop_reasons];
  unsigned lock;
  bool last;
  record best;
  search::root_test roots[most_parts];
  stream_part<PartView> parts[inline_parts];
  candidate candidate_table[candidate_capacity];
  survivor survivor_table[block_threads];  ///< One a thread: a batch is as many pairs.
  pending queue[queue_capacity];

  __device__ real reach() const { return from_ordered(fresh(bound)); }
  __device__ distance_key best_key() const { return fresh(best.key); }

  __device__ void lower(real distance, frame_state& state) {
    const std::uint32_t u = ordered(distance);
    if (u < atomicMin(&bound, u)) atomicMin(&state.bound, u);
  }

  /// Keeps the better of `best` and `r`. Improvements are rare (a record process), so a lock costs nothing.
  __device__ void offer(const record& r) {
    for (bool kept = false; !kept;) {
      if (atomicCAS(&lock, 0u, 1u) != 0) continue;
      __threadfence_block();
      if (before(r, best)) best = r;
      __threadfence_block();
      atomicExch(&lock, 0u);
      kept = true;
    }
  }

  /// Sets one root test to the present bound. Others may read the old one meanwhile: it is only less sharp.
  __device__ void sharpen(std::uint32_t k, const ball& around) {
    const search::root_test next(around, reach());
    roots[k].m = next.m;
    roots[k].w = next.w;
  }
};

template <class PartView>
__device__ const stream_part<PartView>& part(const frame_args<PartView>& a, const block_memory<PartView>& s, std::uint32_t k) {
  return k < inline_parts ? s.parts[k] : a.more[k - inline_parts];
}

/// What a tree's depth-first stack may need: `build` sees to it.
inline constexpr std::uint32_t deepest_stack = 64;

}  // namespace clearance::stream
