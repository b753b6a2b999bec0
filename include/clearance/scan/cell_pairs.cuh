// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Pairs that need no walk: the point is inside the part's solid, or the part's cells list what can be nearest.

#include <clearance/ground/ordered.hpp>
#include <clearance/result.hpp>
#include <clearance/robot/cells.hpp>
#include <clearance/scan/block.cuh>
#include <clearance/scan/element.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/steps.cuh>
#include <clearance/traversal/near_first.hpp>

namespace clearance::scan {

// What a block's pairs hold: points, or the capsules that they stand for.

template <class Tally>
struct pair_elements : tree_steps<Tally> {
  using frame = frame_parts<Tally>;
  using element = typename Tally::element;

  static constexpr bool sight = decltype(frame::here().head.answer.around)::sight;
  /// What many tests against balls take of a capsule.
  using root_element = std::conditional_t<sight, frames::sight_test, frames::capsule_test>;
  /// That of a point of this cloud less the origin; it passes no test if there is no such point.
  static __device__ root_element root_element_at(std::uint32_t i, vec3 x, bool any) {
    if constexpr (sight)
      return root_element(any ? x : vec3{not_a_number, 0, 0}, frame::here().origin);
    else
      return root_element(any ? element_at(i, x) : capsule{{not_a_number, 0, 0}, {0, 0, 0}, 0});
  }
  /// A point of this cloud less the origin, or its capsule.
  static __device__ element element_at(std::uint32_t i, vec3 x) {
    if constexpr (std::is_same_v<element, vec3>)
      return x;
    else
      return frame::here().head.answer.around.less(i, x, frame::here().origin);
  }
  /// Is nothing left to learn about a pair, even if it is inside?
  static __device__ bool settled(const typename Tally::block& s, std::uint32_t part, std::uint32_t point, vec3) {
    return Tally::settled(s, part, point);
  }
  static __device__ bool settled(const typename Tally::block& s, std::uint32_t part, std::uint32_t point,
                                 const capsule& all) {
    return Tally::settled(s, part, point) || (all.radius == 0 && Tally::touched(s, part, point));
  }
  /// May a point inside settle its part? Not a capsule's: what has touched before is passed over, in any order.
  static __device__ bool is_certain(const typename Tally::block& s) {
    return std::is_same_v<element, vec3> && Tally::wants_certain(s);
  }
  static __device__ bool near_part(const typename Tally::block& s, std::uint32_t part, vec3 x) {
    return s.near_part[part].passes(x);
  }
  static __device__ bool near_part(const typename Tally::block& s, std::uint32_t part, const capsule& x) {
    return s.near_part[part].passes(frames::capsule_test(x));
  }
};

/// One thread walks a tree by itself. For too deep a tree the block has a stack in memory, for one thread at a time.
template <class Tally>
struct walk_alone {
  template <hierarchy H, visitor Q>
  __device__ void operator()(const H& tree, vec3 p, Q& q) const {
    auto& s = memory_of_block<Tally>();
    if constexpr (!node_of<H>::any_size) return near_first{}(tree, p, q);
    if (s.head.overflow == nullptr) return near_first{}(tree, p, q);
    using entry = near_first::entry_of<H>;
    static_assert(sizeof(entry) <= sizeof(typename Tally::block::pending_type));
    auto* const own = reinterpret_cast<typename Tally::block::pending_type*>(s.head.overflow) +
                      std::size_t(gridDim.x * warps + blockIdx.x) * s.head.overflow_room;
    for (bool done = false; !done;) {
      if (atomicCAS(&s.overflow_lock, 0u, 1u) != 0) continue;
      __threadfence_block();
      near_first::walk(tree, p, q, reinterpret_cast<entry*>(own));
      __threadfence_block();
      atomicExch(&s.overflow_lock, 0u);
      done = true;
    }
  }
};

template <class Tally>
struct cell_pairs : pair_elements<Tally> {
  using frame = frame_parts<Tally>;
  using steps = tree_steps<Tally>;
  using hierarchy = typename Tally::part_type::hierarchy_type;
  using memory = typename Tally::block;
  using typename pair_elements<Tally>::element;
  static constexpr std::uint32_t mates = 4;  ///< Lanes that share a pair or a node.
  static constexpr bool by_cells = std::is_same_v<element, vec3> && has_cells<typename Tally::part_type>;

  static __device__ std::uint32_t lane() { return threadIdx.x % mates; }
  static __device__ std::uint32_t group() { return threadIdx.x % 32 / mates; }

  /// Is it in the part's solid? Then its distance is 0, and the tree need not be searched.
  static __device__ bool inside(const element& e, std::uint32_t point, std::uint32_t k, std::uint32_t pair) {
    if constexpr (has_interior<typename Tally::part_type>) {
      memory& s = frame::here();
      if (cell_pairs::settled(s, k, point, e)) return true;
      const auto& view = frame::view(k);
      if constexpr (by_cells)
        if (view.cells(e).node.outside) return false;
      if (!view.interior.inside(start_of(e))) return false;
      Tally::take_inside(s, k, point, pair);
      if (cell_pairs::is_certain(s) && certainly_inside(view, start_of(e), frame::place(k).error, walk_alone<Tally>{}))
        Tally::take_certain(s);
      return true;
    }
    return false;
  }

  /// Tests what is listed for pair `i`, if it is `live`; four lanes per pair, and the whole warp calls it. Returns true
  /// if the pair has to walk its part's tree.
  static __device__ bool look_up(bool live, std::uint32_t i, std::uint32_t part, vec3 q) {
    memory& s = frame::here();
    const cells_view& cells = frame::view(part).cells;
    cell_leaf leaf;
    if (live) leaf = cells(q);
    const std::uint32_t count = leaf.node.kind == cell_kind::list ? leaf.node.count : 0;
#pragma unroll 1
    for (std::uint32_t k = lane();; k += mates) {  // the nearest to the middle first
      cell_candidate c{none, infinity, infinity};
      if (k < count) c = cells.candidate(leaf, k);
      const real reach = Tally::reach_of_pair(s, part, i);
      if (__all_sync(all_lanes, k >= count || c.rest > reach)) break;
      typename Tally::record r;
      typename hierarchy::primitive_type primitive;
      if (k < count && c.low <= reach) {
        primitive = steps::whole_primitive(part, c.place);
        if (const real d = primitive.distance(q); d <= reach)
          r = {make_key(d, s.pair_table[i].point), part, steps::id(part, c.place), c.place};
      }
      if (__any_sync(all_lanes, r.key != no_key)) Tally::take(s, r, primitive, i);
    }
    return live && leaf.node.kind == cell_kind::unlisted;
  }
};

}  // namespace clearance::scan
