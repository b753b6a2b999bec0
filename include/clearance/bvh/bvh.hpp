// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The library's own tree: wide, in arrays, in the memory of any backend.

#include <clearance/concepts.hpp>

namespace clearance {

/// Where a node's children or primitives are; they are contiguous.
struct bvh_node {
  std::uint32_t first;
  std::uint32_t count_and_kind;

  static constexpr std::uint32_t leaf_bit = 0x80000000u;
  CLEARANCE_HD constexpr bool is_leaf() const { return (count_and_kind & leaf_bit) != 0; }
  CLEARANCE_HD constexpr std::uint32_t count() const { return count_and_kind & ~leaf_bit; }
};

/// A hierarchy that shows its arrays. Children and primitives are contiguous, and parents come before their children,
/// level by level. On a device nodes and volumes begin at multiples of 16 bytes. A scan then keeps a node's content,
/// and the first nodes in fast memory.
template <class H>
concept array_hierarchy = hierarchy<H> && requires(const H h) {
  { h.volumes } -> std::convertible_to<const typename H::volume_type*>;
  { h.nodes } -> std::convertible_to<const bvh_node*>;
  { h.primitives } -> std::convertible_to<const typename H::primitive_type*>;
  { h.ids } -> std::convertible_to<const std::uint32_t*>;
  { h.node_count } -> std::convertible_to<std::uint32_t>;
};

/// A trivially copyable view of the library's own wide tree, which kernels receive by value.
template <bounding_volume V, primitive P>
struct bvh_view {
  using node_type = std::uint32_t;
  using volume_type = V;
  using primitive_type = P;

  const V* volumes;
  const bvh_node* nodes;
  const P* primitives;
  const std::uint32_t* ids;  ///< Position of each primitive in the user's array.
  std::uint32_t levels, widest;
  std::uint32_t node_count;  ///< Parents come before their children, level by level, so the first nodes are the top.
  std::uint32_t primitive_count;

  CLEARANCE_HD node_type root() const { return 0; }
  CLEARANCE_HD bool is_leaf(node_type n) const { return nodes[n].is_leaf(); }
  CLEARANCE_HD std::uint32_t size(node_type n) const { return nodes[n].count(); }
  CLEARANCE_HD node_type child(node_type n, std::uint32_t k) const { return nodes[n].first + k; }
  CLEARANCE_HD const V& volume(node_type n) const { return volumes[n]; }
  CLEARANCE_HD const P& primitive(node_type n, std::uint32_t k) const { return primitives[nodes[n].first + k]; }
  CLEARANCE_HD std::uint32_t id(node_type n, std::uint32_t k) const { return ids[nodes[n].first + k]; }
  CLEARANCE_HD std::uint32_t depth() const { return levels; }
  CLEARANCE_HD std::uint32_t width() const { return widest; }
};

struct host;  // so that other backends need no TBB

/// Owns a tree in the memory of backend B. Immutable once built, so that many threads and streams may share it.
template <bounding_volume V, primitive P, class B = host>
struct bvh {
  static_assert(backend<B>);
  template <class T>
  using buffer = typename B::template buffer<T>;

  buffer<V> volumes;
  buffer<bvh_node> nodes;
  buffer<P> primitives;
  buffer<std::uint32_t> ids;
  std::uint32_t depth = 0, width = 0;

  bvh_view<V, P> view() const {
    return {.volumes = volumes.data(),
            .nodes = nodes.data(),
            .primitives = primitives.data(),
            .ids = ids.data(),
            .levels = depth,
            .widest = width,
            .node_count = std::uint32_t(nodes.size()),
            .primitive_count = std::uint32_t(primitives.size())};
  }

  /// A copy of a host tree where `other` runs.
  template <backend Other>
  bvh<V, P, Other> on(const Other& other) const {
    return {other.copy_in(std::span<const V>(volumes)),
            other.copy_in(std::span<const bvh_node>(nodes)),
            other.copy_in(std::span<const P>(primitives)),
            other.copy_in(std::span<const std::uint32_t>(ids)),
            depth,
            width};
  }
};

}  // namespace clearance
