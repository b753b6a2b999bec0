// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points are near which parts: one ball around eight parts first, which keeps almost all points from the eight.

#include <clearance/scan/pairs.cuh>

namespace clearance::scan {

/// Sets the root tests to the present bounds, a thread each; `bound` is all parts', if they share one. Nobody may be
/// reading them.
template <class Answer>
__device__ void sharpen(std::uint32_t thread, std::uint32_t bound) {
  using parts = frame_parts<Answer>;
  auto& s = parts::here();
  if (thread < s.head.parts) {
    const frames::root_ball& root = parts::place(thread).root;
    s.near_part[thread] = {root, frames::limit(root.around, Answer::reach_of_part(s, thread, bound))};
  }
  const std::uint32_t c = thread - most_parts, first = c * cluster;
  if (thread < most_parts || first >= s.head.parts) return;
  const frames::root_ball& root = s.cluster[c];
  real most = -infinity;
  if constexpr (Answer::bound_per_part) {
    for (std::uint32_t k = first; k < first + cluster && k < s.head.parts; ++k)
      most = max(most, frames::limit({{}, parts::place(k).away}, Answer::reach_of_part(s, k, bound)));
  } else {
    most = frames::limit(root.around, Answer::reach_of_part(s, 0, bound));
  }
  s.near_cluster[c] = {root, most};
}

/// Subtracts the frame's origin.
template <class Answer>
__device__ void shift(quad_points& p) {
  const auto& s = frame_parts<Answer>::here();
#pragma unroll
  for (int j = 0; j < quad; ++j) p.at[j] = p.at[j] - s.origin;
}

/// Where a warp has stopped for want of room, if it has (not 0): in the last of so many clusters, of whose pairs with
/// this lane's points `those` are still to be handed over.
struct unfinished {
  std::uint32_t clusters = 0;
  unsigned those = ~0u;
};

/// Hands four points to the search, pair by pair, with the parts of all clusters, or with what was `left` of that;
/// false: there was no room for some. The whole warp calls it.
template <class Answer, class Index>
__device__ bool hand_over(const quad_points& p, Index first, std::uint32_t clusters, unfinished& left) {
  using pairs = pair_search<Answer>;
  const auto& s = pairs::here();
  real square[quad];
#pragma unroll
  for (int j = 0; j < quad; ++j) square[j] = -dot(p.at[j], p.at[j]);
  for (std::uint32_t c = left.clusters == 0 ? 0 : left.clusters - 1; c < clusters; ++c) {
    const frames::root_test together = s.near_cluster[c];
    bool near = false;
#pragma unroll
    for (int j = 0; j < quad; ++j) near |= together.value(p.at[j]) <= square[j];
    if (__any_sync(all_lanes, near)) {
      const frames::root_test* const near_part = s.near_part + c * cluster;
      const std::uint32_t parts = s.head.parts - c * cluster;
      unsigned those = 0;  // a bit a part and point
#pragma unroll
      for (std::uint32_t k = 0; k < cluster; ++k) {
        if (k >= parts) break;
        const frames::root_test test = near_part[k];
#pragma unroll
        for (int j = 0; j < quad; ++j) those |= unsigned(test.value(p.at[j]) <= square[j]) << (quad * k + j);
      }
#pragma unroll
      for (int j = 0; j < quad; ++j)
        if ((p.reasons >> 8 * j & 0xff) != 0) those &= ~(0x11111111u << j);
      those &= left.those;
      if (those != 0) those = pairs::add(those, p, first(), c * cluster);
      if (__any_sync(all_lanes, those != 0)) return left = {c + 1, those}, false;
    }
    left.those = ~0u;
  }
  left.clusters = 0;
  return true;
}

}  // namespace clearance::scan
