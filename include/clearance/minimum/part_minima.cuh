// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The end of a frame if every part has a bound and a minimum.

#include <clearance/minimum/evidence.cuh>

namespace clearance::minimum {

template <class Tally>
struct part_minima {
  using record = typename Tally::record;

  template <class Source>
  static __device__ void hand_in(const scan::scan_arguments<Tally>& a, const Source&) {
    auto& s = scan::memory_of_block<Tally>().answer;
    if (const std::uint32_t t = threadIdx.x; t < a.parts) a.answer.records[t * gridDim.x + blockIdx.x] = s.best[t];
    __syncthreads();
  }

  /// Called by the last block. Independent steps have a thread each.
  template <class Source>
  static __device__ void answer(const scan::scan_arguments<Tally>& a, const Source& source) {
    auto& s = scan::memory_of_block<Tally>().answer;
    auto& state = *a.answer.state;
    const std::uint32_t t = threadIdx.x;
    const bool concludes = t == scan::block_threads - 32 && a.last;
    counted all;
    if (concludes) all = counted(a);
    record best;
    evidence_type mine = merge(a, source, best);
    if (!rigid()) best = {};
    const bool mine_here = mine.r.key != no_key && key_index(mine.r.key) >= a.first;
    if (mine_here && same(mine.r, best)) evidence_type(mine).write(a);
    if (concludes) write_bracket(a, bracket_of(a, best, all.certain), all);
    // Kept for the next frame: every part's minimum.
    if (const std::uint32_t slot = t / 32 + scan::warps * (t & 31); slot < a.parts) {
      state.best[slot] = s.best[slot];
      if (mine_here) {
        a.answer.witnesses[slot] = {mine.r, mine.primitive};
        mine.complete();
        a.answer.minima[slot] = {key_distance(mine.r.key), a.cloud, key_index(mine.r.key) - a.first, mine.r.id};
      } else if (mine.r.key == no_key) {
        a.answer.witnesses[slot].r = {}, a.answer.minima[slot] = {};
      }
    }
  }

 private:
  using evidence_type = evidence<Tally>;
  static __device__ bool rigid() { return scan::memory_of_block<Tally>().rigid; }

  /// Puts every part's best, over all blocks and earlier clouds, into s.best, and gives the best of all to all threads.
  /// Returns the evidence of this thread's part, if it has one (the first lanes of warp w have parts w, w + 16, ...).
  template <class Source>
  static __device__ evidence_type merge(const scan::scan_arguments<Tally>& a, const Source& source, record& best) {
    auto& s = scan::memory_of_block<Tally>().answer;
    const std::uint32_t t = threadIdx.x, lane = t & 31;
    record its;
    for (std::uint32_t slot = t / 32, k = 0; slot < a.parts; slot += scan::warps, ++k) {
      record least = a.first > 0 ? a.answer.state->best[slot] : record{};
#pragma unroll 4
      for (std::uint32_t b = lane; b < gridDim.x; b += 32)
        if (const record r = a.answer.records[slot * gridDim.x + b]; before(r, least)) least = r;
      least = least_of_warp(least);
      if (lane == k) its = least, s.best[slot] = least;
    }
    const evidence_type mine(a, source, rigid() ? its : record{});
    __syncthreads();
    record least;
    for (std::uint32_t k = lane; k < a.parts; k += 32)
      if (before(s.best[k], least)) least = s.best[k];
    best = least_of_warp(least);
    return mine;
  }
};

}  // namespace clearance::minimum
