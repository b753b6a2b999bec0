// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud in one kernel. It finds a first bound, reads every point once and tests it against the parts' balls in the
// cloud's frame. The few near points go to the trees. The last block to finish writes the answer.

#include <clearance/backend/early_start.cuh>
#include <clearance/scan/ahead.cuh>
#include <clearance/scan/filter.cuh>
#include <clearance/scan/finish.cuh>

namespace clearance::scan {

/// After how many rounds the block synchronizes, by how full the table of pairs became last time.
CLEARANCE_HD constexpr std::uint32_t rounds_of_batch(std::uint32_t pairs, std::uint32_t capacity) {
  return pairs <= capacity / 8 ? 32 : pairs <= capacity / 4 ? 16 : 8;
}

template <class Tally, class Source>
__global__ void __launch_bounds__(block_threads, 2)
    scan_kernel(const __grid_constant__ Source source, const __grid_constant__ scan_arguments<Tally> a) {
  using pairs = pair_search<Tally>;
  auto& s = memory_of_block<Tally>();
  const std::uint32_t t = threadIdx.x, rounds = a.rounds, ahead = a.ahead, clusters = (a.parts + cluster - 1) / cluster;
  start_early();
  typename Tally::seeds before(a);
  const cards<Tally> all(rounds);
  point_reader<Source, Tally> reader(source, ahead, all);
  pairs::prepare(a, [&] { reader.fetch(0), before.look(a, source); });
  before.seed(a);
  __syncthreads();
  std::uint32_t bound = Tally::seeds::found(a.parts);
  pairs::fetch_tops(a.parts);
  const bool cold = bound == no_bound;
  if (cold && rounds > 0) {
    __pipeline_wait_prior(0);
    __syncthreads();  // the tops have arrived
    quad_points p = ahead > 0 ? reader.peek() : look_closely(source, a.points, all.index(0));
    if (s.shifted) shift<Tally>(p);
    Tally::seed_cold(p);
    __syncthreads();
    bound = Tally::common_bound(s);
  }
  // Everything that these loops call is inlined: what lives across a call would be kept in memory, for every point. A
  // warp that finds no room for a pair stops, and goes on from there when the table of pairs is empty.
  drop_counter dropped;
  unfinished left;
  std::uint32_t r = 0, end = 0, batch = cold ? 8 : 16;
  for (bool crowd = false; crowd || end < rounds;) {
    sharpen<Tally>(t, bound);
    __syncthreads();
    const bool shifted = s.shifted;
    if (!crowd) end = rounds - end < batch ? rounds : end + batch;
#pragma unroll 1
    for (; r < end; ++r) {
      const bool again = left.clusters != 0;
      const auto look = [&] {
        if constexpr (Tally::goes_ahead) return look_wide(source, a.points, all.index(r));
        return look_closely(source, a.points, all.index(r));
      };
      quad_points p = r < ahead && !again ? reader.take(r) : look();
      if (p.reasons != 0 && !again) dropped.add(p.reasons, s.dropped);
      if constexpr (requires { Tally::meet(s, p.reasons, r); })
        if (!again) Tally::meet(s, p.reasons, all.index(r));
      if (shifted) shift<Tally>(p);
      if (!hand_over<Tally>(p, [&] { return all.index(r); }, clusters, left)) break;
    }
    __pipeline_wait_prior(0);  // the tops have arrived
    dropped.report(s.dropped);
    __syncthreads();
    const std::uint32_t found = s.pairs;
    crowd = found > pair_capacity;
    if (end == rounds || found > pair_capacity * 3 / 4) pairs::drain(found);
    bound = Tally::common_bound(s);
    batch = rounds_of_batch(found, pair_capacity);
  }
  if (rounds == 0) __pipeline_wait_prior(0);
  finish_block<Tally>(a, source);
}

/// How this scan is launched.
struct by_pairs {
  static constexpr std::uint32_t in_block = in_block_round;  ///< Points that a block takes at once.

  template <class Tally, class Source>
  static auto kernel() {
    return scan_kernel<Tally, Source>;
  }

  template <class Tally, class Source>
  static void plan(const Source& source, scan_arguments<Tally>& a, unsigned blocks) {
    a.rounds = (a.points + in_block * blocks - 1) / (in_block * blocks);
    a.ahead = rounds_ahead(source, a.points, blocks);
  }
};

/// The same with fewer points per block, so that small clouds also fill the device. It is for answers that want many
/// pairs: a pair takes longer than reading its point.
struct by_many_pairs : by_pairs {
  static constexpr std::uint32_t in_block = in_block_round / 2;
};

}  // namespace clearance::scan
