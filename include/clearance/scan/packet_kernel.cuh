// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud in one kernel for answers whose bound belongs to a single point: a warp takes 32 neighbours after another.

#include <clearance/scan/filter.cuh>
#include <clearance/scan/finish.cuh>
#include <clearance/scan/packets.cuh>

#include <algorithm>

namespace clearance::scan {

/// May this lane's point be near any part? The whole warp calls it.
template <class Answer>
__device__ bool near_any(vec3 x, std::uint32_t parts) {
  const auto& s = memory_of_block<Answer>();
  bool near = false;
#pragma unroll 1
  for (std::uint32_t c = 0; c * cluster < parts; ++c) {
    const bool perhaps = s.near_cluster[c].passes(x);
    if (!__any_sync(all_lanes, perhaps)) continue;
    for (std::uint32_t k = c * cluster; k < (c + 1) * cluster && k < parts; ++k) near |= perhaps && s.near_part[k].passes(x);
  }
  return near;
}

/// Counts those of a warp's points that do not count, a reason a lane.
__device__ inline void add_dropped(std::uint32_t& dropped, drop_reason mine) {
  if (!__any_sync(all_lanes, mine != drop_reason::none)) return;
#pragma unroll
  for (int reason = 1; reason < drop_reasons; ++reason) {
    const unsigned those = __ballot_sync(all_lanes, int(mine) == reason);
    if (threadIdx.x % 32 == unsigned(reason)) dropped += std::uint32_t(__popc(those));
  }
}

template <class Answer, class Source>
__global__ void __launch_bounds__(block_threads, 2) packet_kernel(const __grid_constant__ Source source,
                                                                  const __grid_constant__ scan_arguments<Answer> a) {
  auto& s = memory_of_block<Answer>();
  const std::uint32_t t = threadIdx.x, lane = t % 32, all_warps = gridDim.x * warps, row = a.rounds;
  std::uint32_t batch = (t / 32 * gridDim.x + blockIdx.x) * row, left = row;
  const auto read = [&](std::uint32_t b) {
    const std::uint64_t i = std::uint64_t(b) * 32 + lane;
    return i < a.points ? source[std::size_t(i)] : sample{{not_a_number, 0, 0}};
  };
  sample next;
  frame_parts<Answer>::prepare(a, [&] { next = read(batch); });
  __syncthreads();
  sharpen<Answer>(t, 0);
  tree_steps<Answer>::fetch_tops(a.parts);
  __pipeline_wait_prior(0);
  __syncthreads();
  std::uint32_t dropped = 0;
  while (std::uint64_t(batch) * 32 < a.points) {
    const std::uint32_t first = batch * 32, index = a.first + first + lane;
    const sample here = next;
    const bool exists = first + lane < a.points;
    ++batch;
    if (--left == 0) {  // rows are dealt as they are asked for: points near the robot take longer
      if (lane == 0) batch = (all_warps + atomicAdd(&a.state->taken, 1u)) * row;
      batch = __shfl_sync(all_lanes, batch, 0), left = row;
    }
    next = read(batch);
    add_dropped(dropped, here.dropped);
    const vec3 x = here.position - s.origin;
    const bool counts = exists && here.valid();
    auto v = Answer::visitor(s, index, counts);
    const bool near = near_any<Answer>(x, a.parts);
    packet_search<Answer>::search(near && counts && s.rigid, x, v);
    if (exists) Answer::take(s, index, counts, v);
  }
  if (lane < drop_reasons && dropped != 0) atomicAdd(&s.dropped[lane], dropped);
  __syncthreads();
  finish_block<Answer>(a, source);
}

/// How such a scan is launched.
struct by_packets {
  static constexpr std::uint32_t in_block = block_threads;  ///< Points that a block takes at once.

  template <class Answer, class Source>
  static auto kernel() {
    return packet_kernel<Answer, Source>;
  }

  template <class Answer, class Source>
  static void plan(const Source&, scan_arguments<Answer>& a, unsigned blocks) {
    a.rounds = std::max(1u, a.points / (32 * 4 * warps * blocks));  // batches in a row: as many as leave each warp four rows
  }
};

}  // namespace clearance::scan
