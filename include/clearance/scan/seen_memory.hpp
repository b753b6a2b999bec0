// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a warp keeps of a walk by tangents (tangent_packets.cuh).

#include <clearance/bvh/bvh.hpp>
#include <clearance/scan/arguments.hpp>
#include <clearance/scan/yardstick.hpp>

namespace clearance::scan {

/// A tree that this walk can take: one in arrays, whose volumes and primitives know their tangents.
template <class H>
concept tangent_hierarchy =
    array_hierarchy<H> && tangent_volume<typename H::volume_type> && tangent_primitive<typename H::primitive_type>;

/// A node of a part's tree, `distance` from the middle of the points.
struct alignas(16) seen_node {
  real distance;
  bvh_node node;
  std::uint32_t part;
};

/// A primitive that a point may be nearest to.
struct alignas(16) seen_primitive {
  vec3 direction;  ///< In the cloud's frame.
  real distance;
};
struct alignas(8) primitive_of_part {
  std::uint32_t part, place;
};

/// A warp's share of shared memory. What all lanes know is here, too, because registers are few.
struct seen_memory {
  static constexpr std::uint32_t at_once = 4;         ///< Nodes whose eight children are looked at together.
  static constexpr std::uint32_t leaves_at_once = 8;  ///< Leaves looked at together, four primitives of each.
  static constexpr std::uint32_t many = 64;           ///< With more pending nodes a warp takes one after the other.
  static constexpr std::uint32_t most_nodes = many + 32 + deepest_stack, most_leaves = leaves_at_once + 32,
                                 most_candidates = 64;
  seen_node nodes[most_nodes];
  seen_node leaves[most_leaves];
  seen_primitive candidates[most_candidates];
  primitive_of_part which[most_candidates];
  surroundings points;     ///< Of all points of the warp.
  real reach;              ///< The largest reach of the points.
  primitive_of_part hint;  ///< What was near to this warp's last points.
};

}  // namespace clearance::scan
