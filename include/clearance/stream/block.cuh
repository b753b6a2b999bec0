// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the threads of one block share: the bound, the parts, the best candidate, and the pairs still to be looked at.

#include <clearance/stream/stream_args.hpp>

namespace clearance::stream {

inline constexpr int block_threads = 512;
inline constexpr int lanes = 8;  ///< Threads that share one pair: one a child of an 8-wide node.
inline constexpr int groups = block_threads / lanes;
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

/// The test of a point x against a part's ball, in three multiply-adds: x.m + w + |x|^2 <= 0 if it may be inside.
struct alignas(16) root_test {
  vec3 m;  ///< -2 c
  real w;  ///< |c|^2 - limit^2, less all rounding; rises as the bound falls.

  __device__ real operator()(vec3 x) const { return fma(x.x, m.x, fma(x.y, m.y, fma(x.z, m.z, w))); }
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
  root_test roots[most_parts];
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
    const vec3 c = around.center;
    const real limit = (reach() + around.radius) * (1 + 4 * slack);
    const real far = length(c);
    const real sum = 2 * far + limit;
    const real margin = 0x1p-20f * (sum * sum + limit * limit);
    roots[k].m = {-2 * c.x, -2 * c.y, -2 * c.z};
    roots[k].w = limit >= 0 ? dot(c, c) - (limit * limit + margin) : infinity;
  }
};

/// A tree from one of its nodes on, for the thread that walks alone when the queue is full.
template <class H>
struct subtree : H {
  bvh_node top;

  static constexpr std::uint32_t top_node = ~0u;
  CLEARANCE_HD std::uint32_t root() const { return top_node; }
  CLEARANCE_HD bvh_node info(std::uint32_t n) const { return n == top_node ? top : this->nodes[n]; }
  CLEARANCE_HD bool is_leaf(std::uint32_t n) const { return info(n).is_leaf(); }
  CLEARANCE_HD std::uint32_t size(std::uint32_t n) const { return info(n).count(); }
  CLEARANCE_HD std::uint32_t child(std::uint32_t n, std::uint32_t k) const { return info(n).first + k; }
  CLEARANCE_HD const typename H::volume_type& volume(std::uint32_t n) const { return this->volumes[n == top_node ? 0 : n]; }
  CLEARANCE_HD const typename H::primitive_type& primitive(std::uint32_t n, std::uint32_t k) const {
    return this->primitives[info(n).first + k];
  }
  CLEARANCE_HD std::uint32_t id(std::uint32_t n, std::uint32_t k) const { return info(n).first + k; }  ///< The place in the tree.
};

/// What is asked of a tree here: it shares the block's bound, and offers every candidate at once.
template <class PartView>
struct block_nearest {
  using result_type = real;

  block_memory<PartView>* block;
  frame_state* state;
  const PartView* view;
  std::uint32_t point, part;

  // A traversal is written for both sides; this query runs on the device alone.
  CLEARANCE_HD real reach() const {
#if defined(__CUDA_ARCH__)
    return block->reach();
#else
    return -infinity;
#endif
  }
  CLEARANCE_HD void offer([[maybe_unused]] std::uint32_t place, [[maybe_unused]] real distance) const {
#if defined(__CUDA_ARCH__)
    if (!(distance <= reach())) return;
    const distance_key key = make_key(distance, point);
    if (key > block->best_key()) return;
    block->lower(distance, *state);
    block->offer({key, part, view->tree.ids[place], place});
#endif
  }
  CLEARANCE_HD real result() const { return reach(); }
};

}  // namespace clearance::stream
