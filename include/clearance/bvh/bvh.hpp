// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/bvh/bvh_view.hpp>

namespace clearance {

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
    return {volumes.data(), nodes.data(), primitives.data(), ids.data(), depth, width, std::uint32_t(nodes.size())};
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
