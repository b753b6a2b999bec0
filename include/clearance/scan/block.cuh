// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the threads of a block share: the parts, the pairs still to be tested, and what the answer keeps.

#include <clearance/scan/arguments.hpp>
#include <clearance/scan/element.hpp>
#include <clearance/scan/nodes.hpp>
#include <clearance/scan/threads.cuh>

#include <cuda_pipeline.h>

namespace clearance::scan {

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
inline constexpr std::uint32_t stack_capacity = 3 * deepest_stack;  ///< Of a warp.

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
  std::uint32_t last;       ///< Not 0 if this is the last block to finish.
  alignas(16) vec3 origin;  ///< Subtracted from points if it is not 0 (`shifted`). It is read as sixteen bytes, with
  bool rigid, shifted;      ///< these, which no thread writes any more by then.
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
  pair_of<typename element_of_tally<Tally>::type> pair_table[pair_capacity];
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

}  // namespace clearance::scan
