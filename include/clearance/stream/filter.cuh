// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points are near which parts: one ball around eight parts first, which keeps almost all points from the eight.

#include <clearance/stream/pairs.cuh>

namespace clearance::stream {

/// Sets the root tests to the present bounds, one a thread. Nobody may be reading them.
template <class PartView, bool Each>
__device__ void sharpen(std::uint32_t thread) {
  using parts = frame_parts<PartView, Each>;
  auto& s = parts::here();
  if (thread < s.head.parts) s.near_part[thread] = search::root_test(parts::place(thread).around, s.reach(thread));
  const std::uint32_t c = thread - most_parts, first = c * cluster;
  if (thread < most_parts || first >= s.head.parts) return;
  real reach = -infinity;
#pragma unroll
  for (std::uint32_t k = first; k < first + cluster; ++k)
    if (k < s.head.parts) reach = max(reach, parts::place(k).away + s.reach(k));
  s.near_cluster[c] = search::root_test({parts::place(first).middle, 0}, reach + 4 * slack * absolute(reach));
}

/// Subtracts the frame's origin.
template <class PartView, bool Each>
__device__ void shift(quad_points& p) {
  const auto& s = frame_parts<PartView, Each>::here();
#pragma unroll
  for (int j = 0; j < quad; ++j) p.at[j] = p.at[j] - s.origin;
}

/// Hands four points to the search, pair by pair, with the parts of the clusters from `begin` to `end`; says which (a bit
/// each) have a pair that found no room. The whole warp calls it.
template <class PartView, bool Each, class Index>
__device__ unsigned hand_over(const quad_points& p, Index first, std::uint32_t begin, std::uint32_t end) {
  using pairs = pair_search<PartView, Each>;
  const auto& s = pairs::here();
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
    const search::root_test* const near_part = s.near_part + c * cluster;
    const std::uint32_t parts = min(cluster, s.head.parts - c * cluster);
    unsigned those = 0;  // a bit a part and point
#pragma unroll
    for (std::uint32_t k = 0; k < cluster; ++k) {
      if (k >= parts) break;
      const search::root_test test = near_part[k];
#pragma unroll
      for (int j = 0; j < quad; ++j) those |= unsigned(test.value(p.at[j]) <= square[j]) << (quad * k + j);
    }
    if (__any_sync(all_lanes, those != 0)) missed |= pairs::add(those, p, first(), c * cluster);
  }
  return missed;
}

}  // namespace clearance::stream
