// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the threads of one block share: the bounds, the parts, the best candidates, and the pairs still to be looked at.

#include <clearance/search/root_test.hpp>
#include <clearance/stream/stream_args.hpp>
#include <clearance/stream/threads.cuh>

#include <cuda_pipeline.h>

namespace clearance::stream {

/// A point near a part: first in the cloud's frame, then in the part's.
struct pair {
  vec3 x;
  std::uint32_t point;
  std::uint32_t part;
};

/// A pair against the children (or primitives) first .. first+count-1 of a node no nearer than `bound`.
struct pending {
  real bound;
  bvh_node node;
  std::uint32_t pair;
};

/// What a tree's depth-first stack may need: `build` sees to it.
inline constexpr std::uint32_t deepest_stack = 64;

/// `Each`: one bound a part, and every part's minimum; else one bound for all.
template <class PartView, bool Each>
struct block_memory {
  using volume_type = typename PartView::hierarchy_type::volume_type;
  static constexpr std::uint32_t pair_capacity = 352, queue_capacity = 832;
  static constexpr std::uint32_t slots = Each ? most_parts : 1;
  /// 73 nodes (three levels) of each of eight sphere trees; as much as leaves room for two blocks on a processor of an H200.
  static constexpr std::uint32_t top_capacity = (Each ? 10000 : 14016) / (sizeof(bvh_node) + sizeof(volume_type));

  frame_head<PartView> head;
  std::uint32_t bound[slots];  ///< ordered(): least of what this block and, at times, all blocks know.
  record best[slots];
  record best_of_warp[warps];  ///< Instead, where all parts share a bound: `best` then has points inside solids alone.
  distance_key least[slots];  ///< The keys of `best`, or soon to be.
  std::uint32_t pairs;
  std::uint32_t children;  ///< Entries of the queue that roots were replaced with.
  std::uint32_t queued[2];  ///< Entries of the queue, by parity of the round.
  std::uint32_t dropped[drop_reasons];
  unsigned lock[slots];
  bool last, rigid, shifted;
  vec3 origin;  ///< Is subtracted from points, if it is not 0 (`shifted`).
  search::root_test near_cluster[most_parts / cluster], near_part[most_parts];
  std::uint32_t parts_at;  ///< Bytes from here to the first `block_part`.
  std::uint16_t top[most_parts];  ///< How many of a tree's first nodes are here.
  std::uint32_t top_stride;
  alignas(16) bvh_node top_nodes[top_capacity];
  alignas(16) volume_type top_volumes[top_capacity];
  pair pair_table[pair_capacity];
  alignas(16) pending queue[queue_capacity];

  static __device__ std::uint32_t slot(std::uint32_t part) { return Each ? part : 0; }
  __device__ real reach(std::uint32_t part) const { return from_ordered(fresh(bound[slot(part)])); }

  __device__ void lower(std::uint32_t part, real distance) {
    const std::uint32_t u = ordered(distance);
    if (u < atomicMin(&bound[slot(part)], u)) atomicMin(&head.state->bound[slot(part)], u);
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

/// One part for one frame: behind `block_memory` and the points on their way, as many as there are.
template <class PartView>
struct alignas(16) block_part {
  frame_part place;
  PartView view;
};

/// A block's shared memory. Functions that are not inlined ask for it themselves, so that they know what kind of memory it is.
template <class PartView, bool Each>
__device__ block_memory<PartView, Each>& memory_of_block() {
  extern __shared__ __align__(16) std::byte stream_memory[];
  return *reinterpret_cast<block_memory<PartView, Each>*>(stream_memory);
}

/// What is far is read as what nobody writes; so compilers do not mix it up with what is in shared memory.
template <class T>
__device__ T far(const T* from) {
  using word = std::conditional_t<alignof(T) % 16 == 0, uint4, std::uint32_t>;
  if constexpr (sizeof(T) % sizeof(word) != 0 || alignof(T) < 4) {
    return *from;
  } else {
    union copy {
      __device__ copy() {}
      T value;
      word words[sizeof(T) / sizeof(word)];
    } c;
#pragma unroll
    for (std::size_t i = 0; i < sizeof(T) / sizeof(word); ++i) c.words[i] = __ldg(reinterpret_cast<const word*>(from) + i);
    return c.value;
  }
}

/// A part's place and tree.
template <class PartView, bool Each>
struct frame_parts {
  using memory = block_memory<PartView, Each>;
  using volume_type = typename memory::volume_type;
  using part_type = block_part<PartView>;

  static __device__ memory& here() { return memory_of_block<PartView, Each>(); }
  static __device__ part_type* parts() {
    extern __shared__ __align__(16) std::byte stream_memory[];
    return reinterpret_cast<part_type*>(stream_memory + here().parts_at);
  }
  static __device__ const frame_part& place(std::uint32_t k) { return parts()[k].place; }
  static __device__ const PartView& view(std::uint32_t k) { return parts()[k].view; }
  /// Are the nodes of a part before `end` in shared memory?
  static __device__ bool at_hand(std::uint32_t k, std::uint32_t end) { return end <= here().top[k]; }
  static __device__ bvh_node node(std::uint32_t k, std::uint32_t n) {
    if (at_hand(k, n + 1)) return here().top_nodes[k * here().top_stride + n];
    return far(view(k).tree.nodes + n);
  }
  static __device__ volume_type volume(std::uint32_t k, std::uint32_t n) {
    if (at_hand(k, n + 1)) return here().top_volumes[k * here().top_stride + n];
    return far(view(k).tree.volumes + n);
  }

  /// Every thread brings a share of it.
  static __device__ void prepare(const frame_args<PartView>& a, std::uint32_t parts_at) {
    extern __shared__ __align__(16) std::byte stream_memory[];
    auto* const parts = reinterpret_cast<part_type*>(stream_memory + parts_at);
    memory& s = here();
    const std::uint32_t t = threadIdx.x, inside = a.parts < inline_parts ? a.parts : inline_parts;
    // Dealt to all warps alike: threads of a warp read kernel arguments one after another.
    const std::uint32_t dealt = (t & 31) * warps + t / 32;
    copy(&part_type::place, parts, a.placed ? a.rest->part : a.part, inside, dealt);
    if (inside < a.parts) copy(&part_type::place, parts + inside, a.rest->part + inside, a.parts - inside, t);
    copy(&part_type::view, parts, a.views, a.parts, t);
    constexpr std::uint32_t head_words = sizeof(s.head) / sizeof(uint4);
    static_assert(sizeof(s.head) % sizeof(uint4) == 0);
    if (const std::uint32_t last = block_threads - 1 - t; last < head_words)
      reinterpret_cast<uint4*>(&s.head)[last] = reinterpret_cast<const uint4*>(static_cast<const frame_head<PartView>*>(&a))[last];
    if (t < drop_reasons) s.dropped[t] = 0;
    if (t < memory::slots) s.bound[t] = a.first == 0 ? no_bound : fresh(a.state->bound[t]), s.best[t] = {}, s.least[t] = no_key, s.lock[t] = 0;
    if (t < warps) s.best_of_warp[t] = {};
    if (t == block_threads - 64) {
      s.origin = a.facts().origin;
      s.shifted = s.origin.x != 0 || s.origin.y != 0 || s.origin.z != 0;
      s.rigid = !a.placed || a.rest->rigid;
      s.parts_at = parts_at;
      s.pairs = s.children = s.queued[0] = s.queued[1] = 0;
      s.top_stride = a.parts == 0 ? 0 : min(memory::top_capacity / a.parts, 128u);
    }
  }

  /// Starts to copy the first nodes of each tree, its top levels: no point then waits for them. After `prepare`.
  static __device__ void fetch_tops(std::uint32_t count) {
    memory& s = here();
    const std::uint32_t stride = s.top_stride, lane = threadIdx.x & 31;
    for (std::uint32_t k = threadIdx.x / 32; k < count; k += warps) {
      const auto& tree = view(k).tree;
      const std::uint32_t top = stride < tree.node_count ? stride : tree.node_count;
      if (lane == 0) s.top[k] = std::uint16_t(top);
      for (std::uint32_t n = lane; n < top; n += 32) {
        fetch(s.top_nodes[k * stride + n], tree.nodes[n]);
        fetch(s.top_volumes[k * stride + n], tree.volumes[n]);
      }
    }
    __pipeline_commit();
  }

 private:
  /// One member of some parts.
  template <class T>
  static __device__ void copy(T part_type::*member, part_type* to, const T* from, std::uint32_t count, std::uint32_t thread) {
    using word = std::conditional_t<sizeof(T) % 16 == 0, uint4, std::uint32_t>;
    constexpr std::uint32_t each = sizeof(T) / sizeof(word);
    static_assert(sizeof(T) % sizeof(word) == 0);
    for (std::uint32_t i = thread; i < count * each; i += block_threads)
      reinterpret_cast<word*>(&(to[i / each].*member))[i % each] = reinterpret_cast<const word*>(from)[i];
  }
  template <class T>
  static __device__ void fetch(T& to, const T& from) {
    constexpr std::size_t step = sizeof(T) % 16 == 0 ? 16 : sizeof(T) % 8 == 0 ? 8 : 4;
    if constexpr (sizeof(T) % step != 0 || alignof(T) < 4) {
      to = from;
    } else {
#pragma unroll
      for (std::size_t b = 0; b < sizeof(T); b += step)
        __pipeline_memcpy_async(reinterpret_cast<char*>(&to) + b, reinterpret_cast<const char*>(&from) + b, step);
    }
  }
};

}  // namespace clearance::stream
