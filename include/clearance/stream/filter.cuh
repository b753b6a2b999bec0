// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points are near which parts: one ball around eight parts first, which keeps almost all points from the eight.

#include <clearance/stream/pairs.cuh>

namespace clearance::stream {

/// Sets the root tests to the present bounds, one a thread. Others may read the old ones meanwhile: those are only less sharp.
template <class PartView, bool Each>
__device__ void sharpen(const frame_args<PartView>& a, block_memory<PartView, Each>& s, std::uint32_t thread) {
  const auto set = [](search::root_test& test, const search::root_test& next) { test.m = next.m, test.w = next.w; };
  if (thread < a.parts) set(s.near_part[thread], search::root_test(part(a, s, thread).place.around, s.reach(thread)));
  const std::uint32_t c = thread - most_parts, first = c * cluster;
  if (thread < most_parts || first >= a.parts) return;
  real reach = -infinity;
#pragma unroll
  for (std::uint32_t k = first; k < first + cluster; ++k)
    if (k < a.parts) reach = max(reach, part(a, s, k).away + s.reach(k));
  set(s.near_cluster[c], search::root_test({part(a, s, first).middle, 0}, reach + 4 * slack * absolute(reach)));
}

/// Hands four points to the search, pair by pair, with the parts of the clusters from `begin` to `end`; says which (a bit
/// each) have a pair that found no room.
template <class PartView, bool Each, class Index>
__device__ unsigned hand_over(pair_search<PartView, Each> pairs, const quad_points& p, Index first, std::uint32_t begin, std::uint32_t end) {
  const auto& s = pairs.s;
  real square[quad];
#pragma unroll
  for (int j = 0; j < quad; ++j) square[j] = -dot(p.at[j], p.at[j]);
  unsigned missed = 0;
  for (std::uint32_t c = begin; c < end; ++c) {
    const search::root_test together = s.near_cluster[c];
    bool near = false;
#pragma unroll
    for (int j = 0; j < quad; ++j) near |= together.value(p.at[j]) <= square[j];
    if (!__any_sync(all_lanes, near)) continue;
    unsigned those = 0;  // a bit a part and point
#pragma unroll
    for (std::uint32_t k = 0; k < cluster; ++k) {
      if (c * cluster + k >= pairs.a.parts) break;
      const search::root_test test = s.near_part[c * cluster + k];
#pragma unroll
      for (int j = 0; j < quad; ++j) those |= unsigned(test.value(p.at[j]) <= square[j]) << (quad * k + j);
    }
    if (__any_sync(all_lanes, those != 0)) missed |= pairs.add(those, p, first(), c * cluster);
  }
  return missed;
}

/// Takes over what other blocks have found. The whole block calls it.
template <class PartView, bool Each>
__device__ void refresh(const frame_args<PartView>& a, block_memory<PartView, Each>& s) {
  if (threadIdx.x < (Each ? a.parts : 1)) atomicMin(&s.bound[threadIdx.x], fresh(a.state->bound[threadIdx.x]));
  __syncthreads();
  sharpen(a, s, threadIdx.x);
  __syncthreads();
}

}  // namespace clearance::stream
