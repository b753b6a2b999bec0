// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How a block's threads go down a part's tree.

#include <clearance/scan/block.cuh>
#include <clearance/scan/descend.hpp>

namespace clearance::scan {

template <class Node, class Volume>
struct step_to {
  Node node;
  Volume volume;
};

/// For any tree, by its own members.
template <class Tally, hierarchy H>
struct steps_down : frame_parts<Tally> {
  using parts = frame_parts<Tally>;
  using kind = node_of<H>;
  using node_type = typename kind::type;
  using place_type = typename kind::place;
  using primitive_type = typename H::primitive_type;
  using step = step_to<node_type, typename H::volume_type>;

  static __device__ const H& tree(std::uint32_t k) { return parts::view(k).tree; }
  static __device__ node_type root(std::uint32_t k) { return kind::pack(tree(k).root()); }
  static __device__ bool is_leaf(std::uint32_t k, const node_type& n) { return tree(k).is_leaf(kind::unpack(n)); }
  static __device__ std::uint32_t size(std::uint32_t k, const node_type& n) { return tree(k).size(kind::unpack(n)); }
  static __device__ step child(std::uint32_t k, const node_type& n, std::uint32_t j) {
    const auto c = tree(k).child(kind::unpack(n), j);
    return {kind::pack(c), tree(k).volume(c)};
  }
  static __device__ primitive_type primitive(std::uint32_t k, const place_type& p) {
    return tree(k).primitive(kind::unpack(p.leaf), p.number);
  }
  static __device__ std::uint32_t id(std::uint32_t k, const place_type& p) {
    return tree(k).id(kind::unpack(p.leaf), p.number);
  }
  static __device__ place_type place_of(const node_type& leaf, std::uint32_t j) { return {leaf, j}; }
  /// For a node with more than eight children: the first child that is not pushed yet. Its number, up to `most_width`,
  /// lies in spare bits of the pair's word.
  static __device__ std::uint32_t begin(std::uint32_t pair) {
    return (pair >> 10 & 63 | pair >> 23 << 6) * most_children;
  }
  static __device__ void skip(std::uint32_t& pair) {
    const std::uint32_t eights = begin(pair) / most_children + 1;
    pair = from_first(pair) | (eights & 63) << 10 | eights >> 6 << 23;
  }
  /// Clears that number, because it does not apply to a child.
  static __device__ std::uint32_t from_first(std::uint32_t pair) { return pair & 0x7f03ff; }
  static __device__ std::uint32_t pair_of(std::uint32_t pair) { return pair & 1023; }
  static __device__ std::uint32_t part_of(std::uint32_t pair) { return pair >> 16 & 127; }
  static __device__ void fetch_tops(std::uint32_t) {}
};

/// For a tree in arrays. Its top is read from shared memory.
template <class Tally, array_hierarchy H>
struct steps_down<Tally, H> : frame_parts<Tally> {
  using parts = frame_parts<Tally>;
  using node_type = bvh_node;
  using place_type = std::uint32_t;
  using primitive_type = typename H::primitive_type;
  using volume_type = typename H::volume_type;
  using step = step_to<bvh_node, volume_type>;

  static __device__ const H& tree(std::uint32_t k) { return parts::view(k).tree; }
  static __device__ bvh_node root(std::uint32_t k) { return node(k, 0); }
  static __device__ bool is_leaf(std::uint32_t, const bvh_node& n) { return n.is_leaf(); }
  static __device__ std::uint32_t size(std::uint32_t, const bvh_node& n) { return n.count(); }
  static __device__ step child(std::uint32_t k, const bvh_node& n, std::uint32_t j) {
    const std::uint32_t c = n.first + j;
    return {node(k, c), volume(k, c)};
  }
  static __device__ primitive_type primitive(std::uint32_t k, std::uint32_t place) {
    return read_only(tree(k).primitives + place);
  }
  /// A primitive from global memory, in as few pieces as the size allows: for lanes that read different ones.
  static __device__ primitive_type whole_primitive(std::uint32_t k, std::uint32_t place) {
    return whole(tree(k).primitives + place);
  }
  static __device__ step whole_child(std::uint32_t k, const bvh_node& n, std::uint32_t j) {
    const std::uint32_t c = n.first + j;
    return {whole(tree(k).nodes + c), whole(tree(k).volumes + c)};
  }
  static __device__ std::uint32_t id(std::uint32_t k, std::uint32_t place) { return read_only(tree(k).ids + place); }
  static __device__ std::uint32_t place_of(const bvh_node& leaf, std::uint32_t j) { return leaf.first + j; }
  static __device__ std::uint32_t pair_of(std::uint32_t pair) { return pair & 0xffff; }
  static __device__ std::uint32_t part_of(std::uint32_t pair) { return pair >> 16; }

  /// After `prepare`: starts to copy the first nodes of each tree, its top levels, so that no point waits for them.
  static __device__ void fetch_tops(std::uint32_t count) {
    auto& tops = parts::here().tops;
    const std::uint32_t stride = parts::here().head.top_stride;
#pragma unroll 1
    for (std::uint32_t k = threadIdx.x / 64; k < count; k += warps / 2) {  // two warps per tree
      const H& from = tree(k);
      const std::uint32_t top = stride < from.node_count ? stride : from.node_count;
#pragma unroll 1
      for (std::uint32_t n = threadIdx.x % 64; n < top; n += 64) {
        fetch(tops.nodes[k * stride + n], from.nodes[n]);
        fetch(tops.volumes[k * stride + n], from.volumes[n]);
      }
    }
    __pipeline_commit();
  }

 private:
  /// Node n of part k, and its volume: from shared memory if it is one of the first.
  static __device__ bvh_node node(std::uint32_t k, std::uint32_t n) {
    if constexpr (Tally::top_bytes > 0)
      if (const std::uint32_t stride = parts::here().head.top_stride; n < stride)
        return near(parts::here().tops.nodes + k * stride + n);
    return far(tree(k).nodes + n);
  }
  static __device__ volume_type volume(std::uint32_t k, std::uint32_t n) {
    if constexpr (Tally::top_bytes > 0)
      if (const std::uint32_t stride = parts::here().head.top_stride; n < stride)
        return near(parts::here().tops.volumes + k * stride + n);
    return far(tree(k).volumes + n);
  }
  /// Reads in as few pieces as the size allows, whatever alignment the members have: these arrays are aligned for the
  /// largest piece. Not for a minimum, whose walks wait for one another and not for reads.
  template <class T>
  static constexpr std::size_t piece = sizeof(T) % 16 == 0  ? 16
                                       : sizeof(T) % 8 == 0 ? 8
                                                            : 4;
  template <class T>
  static constexpr bool has_pieces = sizeof(T) % piece<T> == 0 && alignof(T) >= 4;
  template <class T, class Read>
  static __device__ T in_pieces(const T* from, const Read& read) {
    using word = std::conditional_t<piece<T> == 16, uint4, std::conditional_t<piece<T> == 8, uint2, std::uint32_t>>;
    as_words<T, word> c;
#pragma unroll
    for (std::size_t i = 0; i < sizeof(T) / sizeof(word); ++i)
      c.words[i] = read(reinterpret_cast<const word*>(from) + i);
    return c.value;
  }
  template <class T>
  static __device__ T near(const T* from) {
    if constexpr (Tally::goes_ahead && has_pieces<T>) return in_pieces(from, [](const auto* word) { return *word; });
    return *from;
  }
  template <class T>
  static __device__ T whole(const T* from) {
    if constexpr (has_pieces<T>) return in_pieces(from, [](const auto* word) { return __ldg(word); });
    return read_only(from);
  }
  template <class T>
  static __device__ T far(const T* from) {
    if constexpr (Tally::goes_ahead) return whole(from);
    return read_only(from);
  }
  template <class T>
  static __device__ void fetch(T& to, const T& from) {
    if constexpr (!has_pieces<T>) {
      to = from;
    } else {
#pragma unroll
      for (std::size_t b = 0; b < sizeof(T); b += piece<T>)
        __pipeline_memcpy_async(reinterpret_cast<char*>(&to) + b, reinterpret_cast<const char*>(&from) + b, piece<T>);
    }
  }
};

template <class Tally>
struct tree_steps : steps_down<Tally, typename Tally::part_type::hierarchy_type> {};

// Several lanes that go down a tree together.

/// Some lanes of a warp. The whole warp stays together: groups that diverge would wait for one another.
template <std::uint32_t Size>
struct lanes {
  static constexpr std::uint32_t size = Size;
  __device__ std::uint32_t rank() const { return threadIdx.x % size; }
  __device__ bool any(bool mine) const { return __any_sync(all_lanes, mine); }
  __device__ real least(real mine) const {
    for (std::uint32_t step = 1; step < size; step *= 2) mine = min(mine, __shfl_xor_sync(all_lanes, mine, step));
    return mine;
  }
  __device__ int first(bool mine) const {
    const std::uint32_t first_lane = threadIdx.x & (32 - size);
    const unsigned wanted = __ballot_sync(all_lanes, mine) >> first_lane & ((1u << size) - 1);
    return wanted != 0 ? int(first_lane) + __ffs(int(wanted)) - 1 : -1;
  }
  __device__ bool is(int lane) const { return int(threadIdx.x & 31) == lane; }
  template <class T>
  __device__ T from(int lane, const T& mine) const {
    return from_lane(mine, lane < 0 ? int(threadIdx.x & 31) : lane);
  }
};
using eight_lanes = lanes<8>;

/// A part's tree as `descend` takes it.
template <class Tally>
struct steps_of_part {
  using steps = tree_steps<Tally>;
  using node_type = typename steps::node_type;
  using volume_type = typename Tally::hierarchy_type::volume_type;
  std::uint32_t part;

  __device__ node_type root() const { return steps::root(part); }
  __device__ bool is_leaf(const node_type& n) const { return steps::is_leaf(part, n); }
  __device__ std::uint32_t size(const node_type& n) const { return steps::size(part, n); }
  __device__ auto child(const node_type& n, std::uint32_t j) const { return steps::child(part, n, j); }
  __device__ real distance(const node_type& n, std::uint32_t j, vec3 q) const {
    return steps::primitive(part, steps::place_of(n, j)).distance(q);
  }
};

}  // namespace clearance::scan
