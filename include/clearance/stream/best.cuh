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

/// One minimum: every warp keeps its own, so that no warp waits for another.
template <bool Each>
class best_of_block {
 public:
  template <class Memory>
  explicit __device__ best_of_block(const Memory& s) : best_(s.best_of_warp[threadIdx.x / 32]) {}

  /// The whole warp calls it.
  template <class Memory>
  __device__ void take(const record& r, Memory& s) {
    if (!__any_sync(all_lanes, before(r, best_))) return;
    const record least = least_of_warp(r);
    if (!before(least, best_)) return;
    best_ = least;
    if ((threadIdx.x & 31) == 0) s.lower(0, key_distance(least.key));
  }
  template <class Memory>
  __device__ void leave(Memory& s) const {
    if ((threadIdx.x & 31) == 0) s.best_of_warp[threadIdx.x / 32] = best_;
  }

 private:
  record best_;
};

/// One a part: the lanes that share a part agree first, then the block by an atomic minimum: so few come to the lock.
template <>
class best_of_block<true> {
 public:
  template <class Memory>
  explicit __device__ best_of_block(const Memory&) {}

  template <class Memory>
  __device__ void take(const record& r, Memory& s) {
    if (!__any_sync(all_lanes, r.key != no_key)) return;
    const std::uint32_t mine = std::uint32_t(r.key >> 32);
    const std::uint32_t least = least_of(__match_any_sync(all_lanes, r.part), mine);
    if (r.key == no_key || mine != least || r.key > atomicMin(&s.least[r.part], r.key)) return;
    s.lower(r.part, key_distance(r.key));
    s.offer(r);
  }
  template <class Memory>
  __device__ void leave(Memory&) const {}
};

}  // namespace clearance::stream
