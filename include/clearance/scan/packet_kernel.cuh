// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud in one kernel, for answers whose bound belongs to a single point. A warp takes one packet of 32 neighbours
// after another, and then helps other warps.

#include <clearance/backend/early_start.cuh>
#include <clearance/scan/filter.cuh>
#include <clearance/scan/finish.cuh>
#include <clearance/scan/packet_walks.cuh>

#include <algorithm>

namespace clearance::scan {

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
    const unsigned those = __ballot_sync(all_lanes, int(mine) == reason);
    if (threadIdx.x % 32 == unsigned(reason)) dropped += std::uint32_t(__popc(those));
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
    const sample here = next;
    if (own) {
      ++packet, --left;
      if (left != 0) next = read(packet);
      add_dropped(dropped, here.dropped);
    }
    const vec3 x = here.position - s.origin;
    const bool exists = i < a.points, counts = exists && here.valid();
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
      packet = __shfl_sync(all_lanes, packet, 0), left = row;
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
