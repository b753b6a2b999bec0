// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud in one kernel: a first bound, every point read once and tested against the parts' balls in its own frame, the few
// near ones against the trees. The last block to finish writes the answer.

#include <clearance/stream/filter.cuh>
#include <clearance/stream/finish.cuh>
#include <clearance/stream/seeds.cuh>

namespace clearance::stream {

inline constexpr std::uint32_t batch = 32 / quad;  ///< Rounds after which the block comes together: a bit a point.

template <class PartView, bool Each, class Source>
__global__ void __launch_bounds__(block_threads, 2) stream_kernel(const __grid_constant__ Source source,
                                                                  const __grid_constant__ frame_args<PartView> a) {
  using pairs = pair_search<PartView, Each>;
  auto& s = memory_of_block<PartView, Each>();
  constexpr std::size_t before_ring = sizeof(block_memory<PartView, Each>);
  static_assert(before_ring % 16 == 0);
  point_reader<Source, before_ring> reader(source, a.points, a.ring);
  const std::uint32_t t = threadIdx.x, rounds = reader.rounds(), clusters = (a.parts + cluster - 1) / cluster;
  const last_frame<PartView, Each> before(*a.state);
  reader.fetch(0);
  pairs::prepare(a, std::uint32_t(before_ring + (a.ring ? ring_bytes<Source>() : 0)));
  __syncthreads();
  before.seed(a, source);
  pairs::fetch_tops(a.parts);  // is waited for with the first round of points
  for (std::uint32_t r = 1; r + 1 < stages; ++r) reader.fetch(r);  // not before the seeds, which would wait behind them
  __syncthreads();
  if (__syncthreads_or(t < (Each ? a.parts : 1) && s.bound[t] == no_bound) && rounds > 0) {
    __pipeline_wait_prior(0);
    __syncthreads();  // the tops are there
    quad_points p = reader.peek();
    if (s.shifted) shift<PartView, Each>(p);
    seed_cold<PartView, Each>(p);
    __syncthreads();
  }
  // All that this loop calls is inlined, and once: what lives across a call would be kept in memory, for every point.
  // Points that found no room for a pair (a bit each of a batch) are read again, for one cluster of parts at a time: that is
  // little enough for some always to find room. It is rare.
  bool again = false;
  unsigned roomless = 0, left = 0;  // of all clusters, and of this one
  for (std::uint32_t first = 0, begin = 0; first < rounds;) {
    sharpen<PartView, Each>(t);
    __syncthreads();
    const bool shifted = s.shifted;
    const std::uint32_t end = again ? begin + 1 : clusters;
    unsigned missed = 0;
    std::uint32_t r = first;
    for (std::uint32_t bits = 0; bits < 32 && r < rounds; bits += quad, ++r) {
      const unsigned which = again ? left >> bits & 0xf : 0xf;
      if (again && !__any_sync(all_lanes, which != 0)) continue;
      if (!again) reader.fetch(r + stages - 1);
      quad_points p = reader.take(r, again, which);
      if (shifted) shift<PartView, Each>(p);
      missed |= hand_over<PartView, Each>(p, [&] { return reader.index(r); }, begin, end) << bits;
    }
    const bool last = r == rounds;
    if (last || !reader.wide) __pipeline_wait_prior(0);  // the tops, if no points came after them
    reader.report(s.dropped);
    __syncthreads();
    const std::uint32_t found = s.pairs;
    const bool crowd = found > pairs::memory::pair_capacity;
    if (again || last || found > pairs::memory::pair_capacity * 3 / 4) pairs::drain(found);
    if (!again) roomless = missed;
    left = again && crowd ? missed : roomless;
    if (again && !crowd) ++begin;
    again = again ? begin < clusters : crowd;
    if (!again) first = r, begin = 0;
  }
  if (rounds == 0) __pipeline_wait_prior(0);
  finish_block<PartView, Each>(a, source);
}

}  // namespace clearance::stream
