// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud in one kernel: a first bound, every point read once and tested against the parts' balls in its own frame, the few
// near ones against the trees. The last block to finish writes the answer.

#include <clearance/stream/filter.cuh>
#include <clearance/stream/finish.cuh>
#include <clearance/stream/ahead.cuh>
#include <clearance/stream/seeds.cuh>

namespace clearance::stream {

/// Rounds after which the block comes together, by how far that filled the table of pairs last time.
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
  seeds before(a);
  const cards<Each> all;
  point_reader<Source, Each> reader(source, ahead, all);
  pairs::prepare(a, [&] { reader.fetch(0), before.look(a, source); });
  before.seed(a);
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
  // All that these loops call is inlined: what lives across a call would be kept in memory, for every point. A warp that finds
  // no room for a pair stops where it is, and goes on from there once the table of pairs is empty.
  drop_counter dropped;
  unfinished left;
  std::uint32_t r = 0, end = 0, batch = cold ? 8 : 16;
  for (bool crowd = false; crowd || end < rounds;) {
    sharpen<PartView, Each>(t, bound);
    __syncthreads();
    const bool shifted = s.shifted;
    if (!crowd) end = rounds - end < batch ? rounds : end + batch;
#pragma unroll 1
    for (; r < end; ++r) {
      const bool again = left.clusters != 0;
      quad_points p = r < ahead && !again ? reader.take(r, all) : look_closely(source, a.points, all.index(r));
      if (p.reasons != 0 && !again) dropped.add(p.reasons);
      if (shifted) shift<PartView, Each>(p);
      if (!hand_over<PartView, Each>(p, [&] { return all.index(r); }, clusters, left)) break;
    }
    __pipeline_wait_prior(0);  // the tops
    dropped.report(s.dropped);
    __syncthreads();
    const std::uint32_t found = s.pairs;
    crowd = found > pairs::memory::pair_capacity;
    if (end == rounds || found > pairs::memory::pair_capacity * 3 / 4) pairs::drain(found);
    bound = fresh(s.bound[0]);
    batch = rounds_of_batch(found, pairs::memory::pair_capacity);
  }
  if (rounds == 0) __pipeline_wait_prior(0);
  finish_block<PartView, Each>(a, source);
}

}  // namespace clearance::stream
