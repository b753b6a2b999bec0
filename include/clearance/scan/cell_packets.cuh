// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points look for what may be nearest to them in cells of the parts (robot/cells.hpp). A warp takes the parts in one
// order, the nearest first, and each lane its own leaf. Points whose cells list nothing walk the trees, alone.

#include <clearance/ground/ordered.hpp>
#include <clearance/robot/cells.hpp>
#include <clearance/scan/lane_sharing.cuh>
#include <clearance/scan/lone_search.cuh>

namespace clearance::scan {

template <class Tally>
struct cell_packet_memory : block_memory<Tally> {
  __device__ void clear() {}
};

template <class Tally>
struct cell_packets : lone_search<Tally> {
  using lone = lone_search<Tally>;
  using frame = frame_parts<Tally>;
  using steps = tree_steps<Tally>;
  static constexpr bool begins_anew = false;

  static __device__ bool receive(given_lanes&) { return false; }

  /// Searches for this lane's point `x`, in the cloud's frame, if it is `live`. The whole warp calls it.
  template <class Visitor>
  static __device__ unsigned search(std::uint32_t, std::uint32_t, unsigned, bool live, vec3 x, Visitor& v) {
    const unsigned points = __ballot_sync(all_lanes, live);
    if (points == 0) return all_lanes;
    const vec3 middle = from_lane(x, __ffs(int(points)) - 1);
    const real spread = from_bits(most_of(all_lanes, live ? to_bits(rough_length(x - middle)) : 0)) * (1 + slack);
    const std::uint32_t parts = frame::here().head.parts;
    bool walks = false;
#pragma unroll 1
    for (std::uint32_t begin = 0; begin < parts; begin += 32) {  // one part per lane
      std::uint32_t mine = no_bound;
      if (begin + lone::lane() < parts) {
        const ball around = frame::place(begin + lone::lane()).root.around;
        const real d = rough_length(middle - around.center);
        mine = ordered(lowered(d - around.radius - spread, d + around.radius + spread));
      }
#pragma unroll 1
      for (;;) {
        const std::uint32_t nearest = least_of(all_lanes, mine);
        if (!__any_sync(all_lanes, live && from_ordered(nearest) <= v.reach(0)) || nearest == no_bound) break;
        const std::uint32_t its = std::uint32_t(__ffs(int(__ballot_sync(all_lanes, mine == nearest)))) - 1;
        if (lone::lane() == its) mine = no_bound;
        walks |= look(begin + its, live, x, v);
      }
    }
    if (__any_sync(all_lanes, walks)) v = lone::alone(walks, x, v);
    return all_lanes;
  }

 private:
  /// Tests what part k's cells list. Returns true if this lane's point has to walk that part's tree.
  template <class Visitor>
  static __device__ bool look(std::uint32_t k, bool live, vec3 x, Visitor& v) {
    const frame_part& place = frame::place(k);
    live = live && frames::may_reach(place.root.around, v.reach(k), x);
    if (!__any_sync(all_lanes, live)) return false;
    const vec3 q = place.part_from_cloud(x);
    const cells_view& cells = frame::view(k).cells;
    cell_leaf leaf;
    if (live) leaf = cells(q);
    if constexpr (has_interior<typename Tally::part_type>) {
      if (leaf.node.kind == cell_kind::inside) v.offer_inside(k), live = false;
      if (live && !leaf.node.outside && is_inside<Tally>(k, x)) v.offer_inside(k), live = false;
      __syncwarp();
    }
    if (!live) leaf.node.count = 0;
    const auto test = [&](std::uint32_t at) {
      const real d = steps::whole_primitive(k, at).distance(q);
      if (d <= v.reach(k)) v.offer(k, at, steps::id(k, at), d);
    };
    std::uint32_t begin = 0;
    if (leaf.node.count != 0) test(cells.candidate(leaf, 0).place), begin = 1;
#pragma unroll 1
    for (; __any_sync(all_lanes, begin < leaf.node.count); begin += 32) {
      const std::uint32_t count = begin < leaf.node.count ? lower_of(32, leaf.node.count - begin) : 0;
      unsigned wanted = 0;
#pragma unroll 4
      for (std::uint32_t j = 0; j < count; ++j)
        if (cells.candidate(leaf, begin + j).low <= v.reach(k)) wanted |= 1u << j;
#pragma unroll 1
      while (__any_sync(all_lanes, wanted != 0)) {
        if (wanted != 0) {
          const cell_candidate c = cells.candidate(leaf, begin + std::uint32_t(__ffs(int(wanted))) - 1);
          wanted &= wanted - 1;
          if (c.low <= v.reach(k)) test(c.place);
        }
        __syncwarp();
      }
    }
    return live && leaf.node.kind == cell_kind::unlisted;
  }
};

}  // namespace clearance::scan
