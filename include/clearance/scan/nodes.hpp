// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a block keeps about a tree's node: eight bytes for any tree.

#include <clearance/bvh/bvh_view.hpp>

#include <cstring>

namespace clearance::scan {

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

}  // namespace clearance::scan
