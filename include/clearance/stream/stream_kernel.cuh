// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud in one kernel: a first bound, every point read once and tested against the parts' balls in its own frame, the few
// near ones against the trees. The last block to finish writes the answer.

#include <clearance/stream/filter.cuh>
#include <clearance/stream/finish.cuh>
#include <clearance/stream/ahead.cuh>
#include <clearance/stream/seeds.cuh>

namespace clearance::stream {

/// Rounds after which the block comes together, by how far that filled the table of pairs last time; a bit a round says what
/// is to be done again.
CLEARANCE_HD constexpr std::uint32_t rounds_of_batch(std::uint32_t pairs, std::uint32_t capacity) {
  return pairs <= capacity / 8 ? 32 : pairs <= capacity / 4 ? 16 : 8;
}

template <class PartView, bool Each, class Source>
__global__ void __launch_bounds__(block_threads, 2) stream_kernel(const __grid_constant__ Source source,
                                                                  const __grid_constant__ frame_args<PartView> a) {
  using pairs = pair_search<PartView, Each>;
  using seeds = last_frame<PartView, Each>;
  auto& s = memory_of_block<PartView, Each>();
  const std::uint32_t t = threadIdx.x, rounds = a.rounds, ahead = a.ahead, clusters = (a.parts + cluster - 1) / cluster;
  const seeds before(a);
  const cards<Each> all;
  point_reader<Source, Each> reader(source, ahead, all);
  pairs::prepare(a, [&] { reader.fetch(0); });
  before.seed(a, source);
  __syncthreads();
  std::uint32_t bound = seeds::found(a.parts);
  pairs::fetch_tops(a.parts);
  const bool cold = bound == no_bound;
  if (cold && rounds > 0) {
    __pipeline_wait_prior(0);
    __syncthreads();  // the tops are there
    quad_points p = ahead > 0 ? reader.peek(all) : look_closely(source, a.points, all.index(0));
    if (s.shifted) shift<PartView, Each>(p);
    seed_cold<PartView, Each>(p);
    __syncthreads();
    bound = s.bound[0];
  }
  // All that these loops call is inlined: what lives across a call would be kept in memory, for every point. What found no room
  // for a pair (a bit a round of a batch) is read again, for one cluster of parts at a time: that is little enough for some
  // always to find room. It is rare.
  drop_counter dropped;
  std::uint32_t batch = cold ? 8 : 16;
  bool again = false;
  unsigned roomless = 0, left = ~0u;  // of all clusters, and what this turn is about
  for (std::uint32_t first = 0, begin = 0; first < rounds;) {
    sharpen<PartView, Each>(t, bound);
    __syncthreads();
    const bool shifted = s.shifted;
    const search::root_test near_first = s.near_cluster[begin];
    const std::uint32_t end = rounds - first < batch ? rounds : first + batch;
    unsigned missed = 0, bit = 1;
    std::uint32_t r = first;
    if (!again) {
      for (const std::uint32_t fast = ahead < end ? ahead : end; r < fast; ++r, bit *= 2) {
        quad_points p = reader.take(r, all);
        if (p.reasons != 0) dropped.add(p.reasons);
        if (shifted) shift<PartView, Each>(p);
        if (hand_over<PartView, Each>(p, [&] { return all.index(r); }, near_first, 0, clusters) != 0) missed |= bit;
      }
    }
#pragma unroll 1
    for (; r < end; ++r, bit *= 2) {
      const bool mine = (left & bit) != 0;
      if (!__any_sync(all_lanes, mine)) continue;
      quad_points p = look_closely(source, mine ? a.points : 0, all.index(r));
      if (!again) dropped.add(p.reasons);
      if (shifted) shift<PartView, Each>(p);
      if (hand_over<PartView, Each>(p, [&] { return all.index(r); }, near_first, begin, again ? begin + 1 : clusters) != 0) missed |= bit;
    }
    __pipeline_wait_prior(0);  // the tops
    dropped.report(s.dropped);
    __syncthreads();
    const std::uint32_t found = s.pairs;
    const bool crowd = found > pairs::memory::pair_capacity;
    if (again || end == rounds || found > pairs::memory::pair_capacity * 3 / 4) pairs::drain(found);
    bound = fresh(s.bound[0]);
    if (!again) roomless = missed;
    left = again && crowd ? missed : roomless;
    if (again && !crowd) ++begin;
    again = again ? begin < clusters : crowd;
    if (again) continue;
    first = end, begin = 0, left = ~0u;
    batch = rounds_of_batch(found, pairs::memory::pair_capacity);
  }
  if (rounds == 0) __pipeline_wait_prior(0);
  finish_block<PartView, Each>(a, source);
}

}  // namespace clearance::stream
