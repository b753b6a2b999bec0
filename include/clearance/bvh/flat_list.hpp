// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A list that passes for a tree: for a few primitives, or to check a tree's answers.

#include <clearance/concepts.hpp>

namespace clearance {

/// A hierarchy without a tree: one leaf holds everything. For a handful of primitives, and as an oracle.
template <bounding_volume V, clearance::primitive P>
struct flat_list {
  using node_type = std::uint32_t;
  using volume_type = V;
  using primitive_type = P;

  V bounds;
  const P* primitives;
  std::uint32_t count;

  CLEARANCE_HD node_type root() const { return 0; }
  CLEARANCE_HD bool is_leaf(node_type) const { return true; }
  CLEARANCE_HD std::uint32_t size(node_type) const { return count; }
  CLEARANCE_HD node_type child(node_type, std::uint32_t) const { return 0; }
  CLEARANCE_HD const V& volume(node_type) const { return bounds; }
  CLEARANCE_HD const P& primitive(node_type, std::uint32_t k) const { return primitives[k]; }
  CLEARANCE_HD std::uint32_t id(node_type, std::uint32_t k) const { return k; }
  CLEARANCE_HD std::uint32_t depth() const { return 0; }
  CLEARANCE_HD std::uint32_t width() const { return 1; }
};

}  // namespace clearance
