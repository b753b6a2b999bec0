// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Pairs that need no walk: the point is inside the part's solid, or the part's cells list what can be nearest.

#include <clearance/ground/ordered.hpp>
#include <clearance/result.hpp>
#include <clearance/robot/cells.hpp>
#include <clearance/scan/alone.cuh>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/pair_elements.cuh>

namespace clearance::scan {

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
    const cells_view& its = frame::view(part).cells;
    cell_leaf leaf;
    if (live) leaf = its(q);
    const std::uint32_t count = leaf.node.kind == cell_kind::list ? leaf.node.count : 0;
#pragma unroll 1
    for (std::uint32_t k = lane();; k += mates) {  // the nearest to the middle first
      cell_candidate c{none, infinity, infinity};
      if (k < count) c = its.candidate(leaf, k);
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
