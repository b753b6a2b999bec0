// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The best candidates that a block has found.

#include <clearance/minimum/kept_best.hpp>
#include <clearance/scan/pairs.cuh>

namespace clearance::minimum {

/// Returns the least of a warp's records to all its lanes.
template <class Record>
__device__ Record least_of_warp(const Record& r) {
  using scan::all_lanes;
  unsigned those = all_lanes;
  const auto keep = [&those](std::uint32_t value) {
    const bool in = those >> (threadIdx.x & 31) & 1;
    const std::uint32_t least = scan::least_of(all_lanes, in ? value : none);
    those = __ballot_sync(all_lanes, in && value == least);
  };
  keep(std::uint32_t(r.key >> 32));
  if ((those & (those - 1)) != 0) keep(std::uint32_t(r.key)), keep(r.part), keep(r.id);  // a tie of distances
  const int from = __ffs(int(those)) - 1;
  Record least;
  least.key = __shfl_sync(all_lanes, r.key, from);
  least.part = __shfl_sync(all_lanes, r.part, from);
  least.id = __shfl_sync(all_lanes, r.id, from);
  least.place = scan::from_lane(r.place, from);
  return least;
}

/// Keeps the better of the block's best and `r`. Improvements are rare (a record process), so a lock costs nothing.
template <class Tally>
__device__ void keep_best(typename Tally::block& s, const typename Tally::record& r,
                          const typename Tally::primitive_type& primitive) {
  const std::uint32_t slot = Tally::slot(r.part);
  auto& kept = s.answer.best[slot];
  for (bool offered = false; !offered;) {
    if (atomicCAS(&s.answer.lock[slot], 0u, 1u) != 0) continue;
    __threadfence_block();
    if (before(r, kept)) {
      kept = r;
      if constexpr (!Tally::bound_per_part) s.answer.nearest = primitive;
    }
    __threadfence_block();
    atomicExch(&s.answer.lock[slot], 0u);
    offered = true;
  }
}

/// All lanes of a warp call it. For one minimum the warp agrees on its best first. With one minimum per part, the lanes
/// that share a part agree, and then the block by an atomic minimum. So few lanes reach the lock.
template <class Tally>
__device__ void best_of_warp(typename Tally::block& s, const typename Tally::record& r,
                             const typename Tally::primitive_type& primitive) {
  if constexpr (Tally::bound_per_part) {
    const std::uint32_t mine = std::uint32_t(r.key >> 32);
    const std::uint32_t least = scan::least_of(__match_any_sync(scan::all_lanes, r.part), mine);
    if (r.key == no_key || mine != least || r.key > atomicMin(&s.answer.least[r.part], r.key)) return;
  } else {
    if (!same(r, least_of_warp(r))) return;
  }
  Tally::lower(s, r.part, key_distance(r.key));
  keep_best<Tally>(s, r, primitive);
}

}  // namespace clearance::minimum
