// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the threads of a block share: the parts, the pairs still to be tested, and what the answer keeps.

#include <clearance/bvh/bvh.hpp>
#include <clearance/ground/read_only.hpp>
#include <clearance/scan/arguments.hpp>
#include <clearance/scan/element.hpp>
#include <clearance/scan/threads.cuh>

#include <cuda_pipeline.h>

#include <cstring>

namespace clearance::scan {

// What a block keeps about a tree's node: eight bytes for any tree.

/// A handle of any tree's node, as words.
struct linked_node {
  std::uint32_t words[2];
};

/// For any hierarchy. `place` is where a primitive is found again. `any_size`: trees of any depth and width, whose
/// stacks may continue in memory.
template <hierarchy H>
struct node_of {
  static constexpr bool any_size = true;
  static_assert(sizeof(typename H::node_type) <= sizeof(linked_node),
                "on a device a tree's node_type has at most 8 bytes");
  using type = linked_node;
  struct place {
    linked_node leaf;
    std::uint32_t number;
  };

  CLEARANCE_HD static type pack(const typename H::node_type& n) {
    type packed{};
    memcpy(&packed, &n, sizeof n);
    return packed;
  }
  CLEARANCE_HD static typename H::node_type unpack(const type& packed) {
    typename H::node_type n;
    memcpy(&n, &packed, sizeof n);
    return n;
  }
};

/// For a tree in arrays: the node's content, so that it need not be read again.
template <array_hierarchy H>
struct node_of<H> {
  static constexpr bool any_size = false;
  using type = bvh_node;
  using place = std::uint32_t;
};

/// A point or capsule near a part: first in the cloud's frame, then in the part's.
template <class Element>
struct alignas(16) pair_of {
  Element x;
  std::uint32_t point;
};
using pair = pair_of<vec3>;

/// A pair (in one word with its part) that has to be tested against a node's content, which is no nearer than `bound`.
template <class Node>
struct alignas(16) pending {
  real bound;
  Node node;
  std::uint32_t pair;
};

inline constexpr std::uint32_t pair_capacity = 1024;
inline constexpr std::uint32_t stack_capacity = 3 * deepest_stack;  ///< Entries of a warp's stack.

/// The first nodes of every tree, in `Bytes` bytes, for trees in arrays.
template <hierarchy H, std::size_t Bytes>
struct tree_tops {
  static constexpr std::uint32_t capacity = 0;
};
template <array_hierarchy H, std::size_t Bytes>
  requires(Bytes > 0)
struct tree_tops<H, Bytes> {
  using volume_type = typename H::volume_type;
  static constexpr std::uint32_t capacity = Bytes / (sizeof(bvh_node) + sizeof(volume_type));
  alignas(16) bvh_node nodes[capacity];
  alignas(16) volume_type volumes[capacity];
};

/// What every block has, whatever it does with its points.
template <class Tally>
struct block_memory {
  using hierarchy_type = typename Tally::part_type::hierarchy_type;

  scan_head<Tally> head;
  typename Tally::memory answer;
  std::uint32_t dropped[drop_reasons];
  std::uint32_t last;  ///< Not 0 if this is the last block to finish.
  /// Subtracted from points if it is not 0, which `shifted` says. Sixteen bytes are read at once, the origin and the
  /// two members after it, which no thread writes any more by then.
  alignas(16) vec3 origin;
  bool rigid, shifted;
  frames::root_test near_cluster[most_clusters], near_part[most_parts];
  frames::root_ball cluster[most_clusters];
  tree_tops<hierarchy_type, Tally::top_bytes> tops;
};

/// For a block that tests pairs of a point and a part.
template <class Tally>
struct pair_memory : block_memory<Tally> {
  using pending_type = pending<typename node_of<typename block_memory<Tally>::hierarchy_type>::type>;
  static constexpr std::uint32_t given_capacity = 32 * warps;

  std::uint32_t pairs, given;
  unsigned overflow_lock;
  pair_of<typename Tally::element> pair_table[pair_capacity];
  std::uint16_t part_of_pair[pair_capacity];
  pending_type stack[warps][stack_capacity];
  pending_type given_nodes[given_capacity];

  /// Called by one thread.
  __device__ void clear() { pairs = given = overflow_lock = 0; }
};

/// One part in one frame. These follow `block_memory`, one per part.
template <class PartView>
struct alignas(16) block_part {
  frame_part place;
  PartView view;
};

/// Bytes of shared memory of a block.
template <class Tally>
constexpr std::size_t memory_bytes(std::uint32_t parts) {
  static_assert(sizeof(typename Tally::block) % 16 == 0);
  return sizeof(typename Tally::block) + parts * sizeof(block_part<typename Tally::part_type>);
}

/// A block's shared memory. Functions that are not inlined call it themselves, so that its kind is known.
template <class Tally>
__device__ typename Tally::block& memory_of_block() {
  extern __shared__ __align__(16) std::byte scan_memory[];
  return *reinterpret_cast<typename Tally::block*>(scan_memory);
}

// The parts of a frame in a block's shared memory.

/// A part's place and tree.
template <class Tally>
struct frame_parts {
  using memory = typename Tally::block;
  using view_type = typename Tally::part_type;
  using part_type = block_part<view_type>;

  static __device__ memory& here() { return memory_of_block<Tally>(); }
  static __device__ part_type* parts() {
    extern __shared__ __align__(16) std::byte scan_memory[];
    return reinterpret_cast<part_type*>(scan_memory + sizeof(memory));
  }
  static __device__ const frame_part& place(std::uint32_t k) { return parts()[k].place; }
  static __device__ const view_type& view(std::uint32_t k) { return parts()[k].view; }

  /// Copies them there. Every thread copies a share, and calls `meanwhile` once while it waits for its first words.
  template <class F>
  static __device__ void prepare(const scan_arguments<Tally>& a, F meanwhile) {
    memory& s = here();
    const std::uint32_t t = threadIdx.x;
    // Dealt evenly to all warps, because threads of a warp read kernel arguments one after another.
    const std::uint32_t dealt = (t & 31) * warps + t / 32;
    if (a.far)
      copy_parts(a.rest->parts.part, a.views, a.parts, t, meanwhile);
    else
      copy_parts(a.near.part, a.views, a.parts, dealt, meanwhile);
    constexpr std::uint32_t head_words = sizeof(s.head) / sizeof(uint4),
                            ball_words = sizeof(frames::root_ball) / sizeof(uint2);
    static_assert(sizeof(s.head) % sizeof(uint4) == 0 && sizeof(frames::root_ball) % sizeof(uint2) == 0);
    if (const std::uint32_t last = block_threads - 1 - t; last < head_words)
      reinterpret_cast<uint4*>(&s.head)[last] =
          reinterpret_cast<const uint4*>(static_cast<const scan_head<Tally>*>(&a))[last];
    if (const std::uint32_t i = t - 128; i < (a.parts + cluster - 1) / cluster * ball_words)
      reinterpret_cast<uint2*>(s.cluster)[i] = reinterpret_cast<const uint2*>(a.clusters())[i];
    if (t < drop_reasons) s.dropped[t] = 0;
    s.answer.clear(t);
    if (t == block_threads - 64) {
      s.origin = a.facts().origin;
      s.shifted = s.origin.x != 0 || s.origin.y != 0 || s.origin.z != 0;
      s.rigid = !a.placed || a.rest->rigid;
      s.clear();
    }
  }

 private:
  /// Every thread reads first and then writes, so that it waits once.
  template <class F>
  static __device__ void copy_parts(const frame_part* places, const view_type* views, std::uint32_t count,
                                    std::uint32_t thread, F meanwhile) {
    using word = std::conditional_t<sizeof(view_type) % sizeof(uint4) == 0, uint4, std::uint32_t>;
    constexpr std::uint32_t place_words = sizeof(frame_part) / sizeof(uint4),
                            view_words = sizeof(view_type) / sizeof(word);
    static_assert(sizeof(frame_part) % sizeof(uint4) == 0 && sizeof(view_type) % sizeof(word) == 0);
    const std::uint32_t words = count * (place_words > view_words ? place_words : view_words);
    std::uint32_t i = thread;
#pragma unroll 1
    do {
      const bool of_place = i < count * place_words, of_view = i < count * view_words;
      uint4 place;
      word view;
      if (of_place) place = reinterpret_cast<const uint4*>(places)[i];
      if (of_view) view = reinterpret_cast<const word*>(views)[i];
      if (i == thread) meanwhile();
      if (of_place) reinterpret_cast<uint4*>(&parts()[i / place_words].place)[i % place_words] = place;
      if (of_view) reinterpret_cast<word*>(&parts()[i / view_words].view)[i % view_words] = view;
      i += block_threads;
    } while (i < words);
  }
};

}  // namespace clearance::scan
