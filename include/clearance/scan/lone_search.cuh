// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points that are not neighbours: every lane walks by itself.

#include <clearance/ground/ordered.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/steps.cuh>

namespace clearance::scan {

/// Is a point inside part k's solid? Its code is apart, because few points ask.
template <class Tally>
__noinline__ __device__ bool is_inside(std::uint32_t k, vec3 x) {
  using frame = frame_parts<Tally>;
  const frame_part& place = frame::place(k);
  return frames::may_reach(place.root.around, 0, x) && frame::view(k).interior.inside(place.part_from_cloud(x));
}

/// Each lane has a point and a visitor, which has the members
///   reach(k)                                how near part k must be to the point to matter;
///   offer(k, place, id, distance), where `place` is the primitive's place in the tree; offer_inside(k).
template <class Tally>
struct lone_search : tree_steps<Tally> {
  using frame = frame_parts<Tally>;
  using steps = tree_steps<Tally>;
  using hierarchy = typename Tally::part_type::hierarchy_type;
  using traits = bounding_volume_traits<typename hierarchy::volume_type>;
  using node_type = typename steps::node_type;

  static __device__ std::uint32_t lane() { return threadIdx.x % 32; }

  /// The approximate distance of the nearest part.
  static __device__ real gap_to(vec3 middle) {
    real gap = infinity;
    for (std::uint32_t k = lane(); k < frame::here().head.parts; k += 32)
      gap = min(gap, rough_length(middle - frame::place(k).root.around.center));
    return from_bits(least_of(all_lanes, to_bits(gap)));
  }

  /// Is the point inside part k's solid? Then its tree need not be searched.
  template <class Visitor>
  static __device__ bool inside(std::uint32_t k, vec3 x, Visitor& v) {
    if constexpr (has_interior<typename Tally::part_type>) {
      if (is_inside<Tally>(k, x)) {
        v.offer_inside(k);
        return true;
      }
    }
    return false;
  }

  struct part_node {
    real bound;
    node_type node;
    std::uint32_t part;
  };

  /// Every lane by itself, eight parts after eight. They go step by step: lanes that diverge would run one after
  /// another.
  template <class Visitor>
  static __noinline__ __device__ Visitor alone(bool live, vec3 x, Visitor v) {
    const std::uint32_t parts = frame::here().head.parts;
    part_node stack[deepest_stack + cluster];
#pragma unroll 1
    for (std::uint32_t begin = 0; begin < parts; begin += cluster) {
      part_node next{not_a_number, {}, begin};  // the nearest known node, or nothing (NaN)
      std::uint32_t below = 0;
      const auto keep = [&](part_node e) {
        if (!(next.bound <= e.bound)) {
          const part_node farther = next;
          next = e;
          e = farther;
        }
        if (e.bound == e.bound) stack[below++] = e;
      };

#pragma unroll 1
      for (std::uint32_t k = begin; k < begin + cluster && k < parts; ++k) {
        const ball around = frame::place(k).root.around;
        bool near = live && frames::may_reach(around, v.reach(k), x);
        if (near) near = !inside(k, x, v);
        if (near) keep({lowered(rough_length(x - around.center) - around.radius, around.radius), steps::root(k), k});
        __syncwarp();
      }

#pragma unroll 1
      while (__any_sync(all_lanes, next.bound == next.bound)) {
        const part_node node = next;
        next.bound = not_a_number;
        const std::uint32_t k = node.part, count = node.bound <= v.reach(k) ? steps::size(k, node.node) : 0;
        const bool leaf = count > 0 && steps::is_leaf(k, node.node);
        const vec3 q = frame::place(k).part_from_cloud(x);
#pragma unroll 1
        for (std::uint32_t j = 0; __any_sync(all_lanes, j < count); ++j) {
          if (j < count && leaf) {
            const auto place = steps::place_of(node.node, j);
            if (const real d = steps::primitive(k, place).distance(q); d <= v.reach(k))
              v.offer(k, place, steps::id(k, place), d);
          } else if (j < count) {
            const auto step = steps::child(k, node.node, j);
            if (const real b = traits::lower_bound(step.volume, q); b <= v.reach(k)) keep({b, step.node, k});
          }
          __syncwarp();
        }
        if (!(next.bound == next.bound) && below > 0) next = stack[--below];
      }
    }
    return v;
  }
};

}  // namespace clearance::scan
