// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud in one kernel, for answers whose bound belongs to a single point. A warp takes one packet of 32 neighbours
// after another, and then helps other warps.

#include <clearance/backends/own_stream.cuh>
#include <clearance/ground/ordered.hpp>
#include <clearance/robot/cells.hpp>
#include <clearance/scan/filter.cuh>
#include <clearance/scan/finish.cuh>
#include <clearance/scan/lane_sharing.cuh>
#include <clearance/scan/lone_search.cuh>
#include <clearance/scan/tangent_packets.cuh>

#include <algorithm>

namespace clearance::scan {

// Points look for what may be nearest to them in cells of the parts (robot/cells.hpp). A warp takes the parts in one
// order, the nearest first, and each lane its own leaf. Points whose cells list nothing walk the trees, alone.

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
        const std::uint32_t holder = std::uint32_t(__ffs(int(__ballot_sync(all_lanes, mine == nearest)))) - 1;
        if (lone::lane() == holder) mine = no_bound;
        walks |= examine(begin + holder, live, x, v);
      }
    }
    if (__any_sync(all_lanes, walks)) v = lone::alone(walks, x, v);
    return all_lanes;
  }

 private:
  /// Tests what part k's cells list. Returns true if this lane's point has to walk that part's tree.
  template <class Visitor>
  static __device__ bool examine(std::uint32_t k, bool live, vec3 x, Visitor& v) {
    const frame_part& place = frame::place(k);
    live = live && frames::may_reach(place.root.around, v.reach(k), x);
    if (!__any_sync(all_lanes, live)) return false;
    const vec3 q = place.part_from_cloud(x);
    const cells_view& cells = frame::view(k).cells;
    cell_leaf leaf;
    if (live) leaf = cells(q);

    if constexpr (has_interior<typename Tally::part_type>) {
      if (leaf.node.kind == cell_kind::inside) {
        v.offer_inside(k);
        live = false;
      }
      if (live && !leaf.node.outside && is_inside<Tally>(k, x)) {
        v.offer_inside(k);
        live = false;
      }
      __syncwarp();
    }

    if (!live) leaf.node.count = 0;
    const auto test = [&](std::uint32_t at) {
      const real d = steps::whole_primitive(k, at).distance(q);
      if (d <= v.reach(k)) v.offer(k, at, steps::id(k, at), d);
    };
    std::uint32_t begin = 0;
    if (leaf.node.count != 0) {
      test(cells.candidate(leaf, 0).place);
      begin = 1;
    }

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

/// How packets find what is nearest to their points.
enum class packets_by { bounds, tangents, cells };

template <class Tally, packets_by How>
struct packet_walk {
  using memory = shared_packet_memory<Tally>;
  using type = packet_search<Tally>;
};
template <class Tally>
struct packet_walk<Tally, packets_by::tangents> {
  using memory = tangent_packet_memory<Tally>;
  using type = tangent_packets<Tally>;
};
template <class Tally>
struct packet_walk<Tally, packets_by::cells> {
  using memory = cell_packet_memory<Tally>;
  using type = cell_packets<Tally>;
};

/// May this lane's point be near any part? The whole warp calls it.
template <class Tally>
__device__ bool near_any(vec3 x, std::uint32_t parts) {
  const auto& s = memory_of_block<Tally>();
  bool near = false;
#pragma unroll 1
  for (std::uint32_t c = 0; c * cluster < parts; ++c) {
    const bool perhaps = s.near_cluster[c].passes(x);
    if (!__any_sync(all_lanes, perhaps)) continue;
    for (std::uint32_t k = c * cluster; k < (c + 1) * cluster && k < parts; ++k)
      near |= perhaps && s.near_part[k].passes(x);
  }
  return near;
}

/// Counts a warp's invalid points, one reason per lane.
__device__ inline void add_dropped(std::uint32_t& dropped, drop_reason mine) {
  if (!__any_sync(all_lanes, mine != drop_reason::none)) return;
#pragma unroll
  for (int reason = 1; reason < drop_reasons; ++reason) {
    const unsigned dropped_now = __ballot_sync(all_lanes, int(mine) == reason);
    if (threadIdx.x % 32 == unsigned(reason)) dropped += std::uint32_t(__popc(dropped_now));
  }
}

inline constexpr std::uint32_t tile_columns = 8, tile_rows = 4;

/// Number of this lane's point in packet b. The packet is a row of points, or a tile of an image.
__device__ inline std::uint32_t place_in_packet(std::uint32_t b, std::uint32_t columns) {
  const std::uint32_t lane = threadIdx.x % 32;
  if (columns == 0) return b * 32 + lane;
  const std::uint32_t across = columns / tile_columns, row = b / across, column = b - row * across;
  return (row * tile_rows + lane / tile_columns) * columns + column * tile_columns + lane % tile_columns;
}

template <class Tally, class Source>
__global__ void __launch_bounds__(block_threads, 2)
    packet_kernel(const __grid_constant__ Source source, const __grid_constant__ scan_arguments<Tally> a) {
  using walks = typename packet_walk<Tally, Tally::how>::type;
  start_early();
  auto& s = memory_of_block<Tally>();
  const std::uint32_t t = threadIdx.x, lane = t % 32, all_warps = gridDim.x * warps, row = a.rounds,
                      packets = (a.points + 31) / 32;
  std::uint32_t packet = (t / 32 * gridDim.x + blockIdx.x) * row, left = row, dropped = 0;

  const auto read = [&](std::uint32_t p) {
    const std::uint32_t i = place_in_packet(p, a.columns);
    return i < a.points ? source[i] : sample{{not_a_number, 0, 0}};
  };
  sample next;
  frame_parts<Tally>::prepare(a, [&] { next = read(packet); });
  __syncthreads();
  sharpen<Tally>(t, 0);
  __syncthreads();

  for (;;) {
    const bool own = packet < packets;
    given_lanes work{packet, all_lanes};
    if (!own) {  // none is left: take a part of another warp's packet
      if (!walks::receive(work)) break;
      next = read(work.packet);
    }

    const std::uint32_t p = work.packet;
    const std::uint32_t i = place_in_packet(p, a.columns), index = a.first + i;
    const sample now = next;
    if (own) {
      ++packet;
      --left;
      if (left != 0) next = read(packet);
      add_dropped(dropped, now.dropped);
    }
    const vec3 x = now.position - s.origin;
    const bool exists = i < a.points, counts = exists && now.valid();

    auto v = Tally::visitor(s, index, counts);
    bool live;
    if (own) {
      live = near_any<Tally>(x, a.parts) && counts && s.rigid;
      if (live) Tally::remind(s, index, x, v);
    } else {
      live = (work.lanes >> lane & 1) != 0;
      if (walks::begins_anew && live) Tally::remind(s, index, x, v);
    }

    const unsigned done = walks::search(p, index, work.lanes, live, x, v);
    if ((done >> lane & 1) != 0 && exists) Tally::take(s, index, counts, v);
    if (own && left == 0) {  // a warp gets its next row only when it needs one: some rows take much longer
      if (lane == 0) packet = (all_warps + atomicAdd(&a.state->taken, 1u)) * row;
      packet = __shfl_sync(all_lanes, packet, 0);
      left = row;
      next = read(packet);
    }
  }

  if (lane < drop_reasons && dropped != 0) atomicAdd(&s.dropped[lane], dropped);
  __syncthreads();
  finish_block<Tally>(a, source);
}

/// How this scan is launched.
struct by_packets {
  static constexpr std::uint32_t in_block = block_threads;  ///< Points that a block takes at once.

  template <class Tally, class Source>
  static auto kernel() {
    return packet_kernel<Tally, Source>;
  }

  template <class Tally, class Source>
  static void plan(const Source& source, scan_arguments<Tally>& a, unsigned blocks) {
    // Packets in a row: one, so that all warps end at about the same time; or more, if most points are far away and
    // asking for each packet would take longer.
    a.rounds = Tally::all_near(a.answer) ? 1 : std::clamp(a.points / (32 * 4 * warps * blocks), 1u, 4u);
    a.columns = columns_of(source);
  }

  /// Columns of an image that tiles cover, or 0.
  template <class Source>
  static std::uint32_t columns_of(const Source& source) {
    if constexpr (image_source<Source>) {
      const std::uint32_t columns = source.columns();
      if (columns != 0 && columns % tile_columns == 0 && source.size() % (tile_rows * columns) == 0) return columns;
    }
    return 0;
  }
};

}  // namespace clearance::scan
