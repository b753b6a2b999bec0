// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The end of a frame if all parts share a bound. While a block is counted, three of its warps draft the answer from its
// own best. It is used if the block is the last one and has the best of all, as the slowest often does.

#include <clearance/minimum/evidence.cuh>

namespace clearance::minimum {

/// Drafts the answer from `best`, by three warps: where the point is, what is nearest to it, and the bracket.
template <class Tally, class Source>
__forceinline__ __device__ void draft_answer(const scan::scan_arguments<Tally>& a, const Source& source) {
  auto& block = scan::memory_of_block<Tally>();
  auto& s = block.answer;
  if (threadIdx.x % 32 != 0) return;
  evidence<Tally> e;
  if (threadIdx.x / 32 != 3) e = {a, source, typename Tally::witness_type{s.best[0], s.nearest}};
  switch (threadIdx.x / 32) {
    case 1:
      s.answer.at = e.at(a);
      break;
    case 2: {
      const bool inside = e.complete();
      const contact here = e.touching(a, inside);
      s.answer.nearest = here.nearest, s.answer.normal = here.normal, s.answer.primitive = e.r.id;
      break;
    }
    case 3: {
      const min_distance_result r = bracket_of(a, s.best[0], false);
      s.answer.state = r.state, s.answer.part = r.part, s.answer.distance = r.distance, s.answer.lower = r.lower,
      s.answer.upper = r.upper;
      break;
    }
  }
}

template <class Tally>
struct one_minimum {
  /// Hands the block's best to the last block. Done by the first four warps.
  template <class Source>
  static __device__ void hand_in(const scan::scan_arguments<Tally>& a, const Source& source) {
    auto& block = scan::memory_of_block<Tally>();
    auto& s = block.answer;
    const std::uint32_t t = threadIdx.x;
    if (t >= 128) return;
    const bool known =
        s.best[0].key != no_key && s.best[0].id != none && block.rigid;  // more than a point inside a solid
    if (t == 0) {
      const auto best = s.best[0];
      s.drafted = known ? best.key : no_key;
      a.answer.candidates[blockIdx.x] = {best, s.nearest};
      if (best.key != no_key) atomicMin(&a.answer.state->best_key, best.key);
    } else if (t >= 32 && known) {
      draft_answer(a, source);
    }
    __syncwarp();
  }

  /// Called by the last block: writes the answer, and what is kept for the next frame.
  template <class Source>
  static __device__ void answer(const scan::scan_arguments<Tally>& a, const Source& source) {
    auto& block = scan::memory_of_block<Tally>();
    auto& s = block.answer;
    auto& state = *a.answer.state;
    const std::uint32_t t = threadIdx.x, blocks = gridDim.x;
    const distance_key key = block.rigid ? scan::fresh(state.best_key) : no_key;
    typename Tally::witness_type mine;
    if (t < blocks) mine = a.answer.candidates[t];
    for (std::uint32_t b = t + scan::block_threads; b < blocks; b += scan::block_threads)
      if (const auto c = a.answer.candidates[b]; before(c.r, mine.r)) mine = c;
    const bool here = key != no_key && key_index(key) >= a.first, won = here && mine.r.key == key;
    if (here && s.drafted != key) {
      if (won) s.best[0] = mine.r, s.nearest = mine.primitive;
      __syncthreads();
      if (t >= 32 && t < 128) draft_answer(a, source);
    }
    if (here) {
      min_distance_result& out = *a.answer.result;
      if (t == 32) out.at = s.answer.at, out.cloud = a.cloud, out.point = key_index(key) - a.first;
      if (t == 64) out.nearest = s.answer.nearest, out.normal = s.answer.normal, out.primitive = s.answer.primitive;
      if (t == 96) out.part = s.answer.part;
    }
    if (t == 96 && a.last) {
      const counted all(a);
      min_distance_result r;
      if (here)
        r.state = s.answer.state, r.part = s.answer.part, r.distance = s.answer.distance, r.lower = s.answer.lower,
        r.upper = s.answer.upper;
      else
        r = bracket_of(a, key != no_key ? state.best[0] : typename Tally::record{}, false);
      if (all.certain && r.part != none) r.state = clearance::state::collision, r.lower = r.upper = 0;
      write_bracket(a, r, all);
    }
    if (won) state.best[0] = mine.r;
    if (mine.r.key != no_key)
      if (const std::uint32_t place = won ? 0 : atomicAdd(&s.kept, 1u) + 1; place < 32)
        a.answer.witnesses[place] = mine;
    if (t == 0 && key == no_key) a.answer.witnesses[0].r = {};
  }
};

}  // namespace clearance::minimum
