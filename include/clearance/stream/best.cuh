// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The best candidates that a block has found.

#include <clearance/stream/parts.cuh>

namespace clearance::stream {

/// The least of a warp's records, to all its lanes.
__device__ inline record least_of_warp(const record& r) {
  unsigned those = all_lanes;
  const auto keep = [&those](std::uint32_t value) {
    const bool in = those >> (threadIdx.x & 31) & 1;
    const std::uint32_t least = least_of(all_lanes, in ? value : none);
    those = __ballot_sync(all_lanes, in && value == least);
  };
  keep(std::uint32_t(r.key >> 32));
  if ((those & (those - 1)) != 0) keep(std::uint32_t(r.key)), keep(r.part), keep(r.id);  // a tie of distances
  const int from = __ffs(int(those)) - 1;
  record least;
  least.key = __shfl_sync(all_lanes, r.key, from);
  least.part = __shfl_sync(all_lanes, r.part, from);
  least.id = __shfl_sync(all_lanes, r.id, from);
  least.primitive = __shfl_sync(all_lanes, r.primitive, from);
  return least;
}

template <bool Each>
struct best_of_block;

/// One minimum: a warp agrees first. All lanes of a warp call it.
template <>
struct best_of_block<false> {
  template <class Primitive, class Memory>
  static __device__ void take(const record& r, const Primitive& primitive, Memory& s) {
    if (!same(r, least_of_warp(r))) return;
    s.lower(0, key_distance(r.key));
    s.offer(r, primitive);
  }
};

/// One a part: the lanes that share a part agree first, then the block by an atomic minimum: so few come to the lock.
template <>
struct best_of_block<true> {
  template <class Primitive, class Memory>
  static __device__ void take(const record& r, const Primitive& primitive, Memory& s) {
    const std::uint32_t mine = std::uint32_t(r.key >> 32);
    const std::uint32_t least = least_of(__match_any_sync(all_lanes, r.part), mine);
    if (r.key == no_key || mine != least || r.key > atomicMin(&s.least[r.part], r.key)) return;
    s.lower(r.part, key_distance(r.key));
    s.offer(r, primitive);
  }
};

}  // namespace clearance::stream
