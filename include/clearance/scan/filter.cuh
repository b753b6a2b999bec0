// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Finds which points are near which parts. One ball around eight parts comes first; almost no point passes it.

#include <clearance/scan/pairs.cuh>

namespace clearance::scan {

/// A capsule may be within reach of a part though its middle is not, even if the reach is below minus the part's size.
template <class Tally>
__device__ real limit_for(const ball& around, real reach) {
  const real limit = frames::limit(around, reach);
  return std::is_same_v<typename Tally::element, vec3> ? limit : max(limit, 0);
}

/// Sets the root tests to the present bounds, one thread per test. `bound` is the tally's `common_bound`. No thread may
/// be reading the tests.
template <class Tally>
__device__ void sharpen(std::uint32_t thread, std::uint32_t bound) {
  using parts = frame_parts<Tally>;
  auto& s = parts::here();
  if (thread < s.head.parts) {
    const frames::root_ball& root = parts::place(thread).root;
    s.near_part[thread] = {root, limit_for<Tally>(root.around, Tally::reach_of_part(s, thread, bound))};
  }
  const std::uint32_t c = thread - most_parts, first = c * cluster;
  if (thread < most_parts || first >= s.head.parts) return;
  const frames::root_ball& root = s.cluster[c];
  real most = -infinity;
  if (Tally::bounds_differ(s)) {
    for (std::uint32_t k = first; k < first + cluster && k < s.head.parts; ++k)
      most = max(most, limit_for<Tally>({{}, parts::place(k).away}, Tally::reach_of_part(s, k, bound)));
  } else {
    most = limit_for<Tally>(root.around, Tally::reach_of_part(s, 0, bound));
  }
  s.near_cluster[c] = {root, most};
}

/// Subtracts the frame's origin.
template <class Tally>
__device__ void shift(quad_points& p) {
  const auto& s = frame_parts<Tally>::here();
#pragma unroll
  for (int j = 0; j < quad; ++j) p.at[j] = p.at[j] - s.origin;
}

/// Where a warp has stopped because there was no room. If `clusters` is not 0, it stopped in the last of so many
/// clusters, and `pairs`, a bit for each part and point of this lane, are still to be handed over.
struct unfinished {
  std::uint32_t clusters = 0;
  unsigned pairs = ~0u;
};

/// Hands over four points to the search, pair by pair, with the parts of all clusters, or with those that were `left`.
/// Returns false if some had no room. The whole warp calls it.
template <class Tally, class Index>
__device__ bool hand_over(const quad_points& p, Index first, std::uint32_t clusters, unfinished& left) {
  using pairs = pair_search<Tally>;
  const auto& s = pairs::here();
  constexpr bool points = std::is_same_v<typename pairs::element, vec3>;
  real square[quad];
  typename pairs::root_element elements[quad];
#pragma unroll
  for (int j = 0; j < quad; ++j) {
    if constexpr (points)
      square[j] = -dot(p.at[j], p.at[j]);
    else
      elements[j] = pairs::root_element_at(first() + j, p.at[j], (p.reasons >> 8 * j & 0xff) == 0);
  }

  const auto passes = [&](const frames::root_test& test, int j) {
    if constexpr (points)
      return test.value(p.at[j]) <= square[j];
    else
      return test.passes(elements[j]);
  };

  for (std::uint32_t c = left.clusters == 0 ? 0 : left.clusters - 1; c < clusters; ++c) {
    const frames::root_test together = s.near_cluster[c];
    bool near = false;
#pragma unroll
    for (int j = 0; j < quad; ++j) near |= passes(together, j);
    if (__any_sync(all_lanes, near)) {
      const frames::root_test* const near_part = s.near_part + c * cluster;
      const std::uint32_t parts = s.head.parts - c * cluster;
      unsigned near_pairs = 0;  // one bit per part and point
#pragma unroll
      for (std::uint32_t k = 0; k < cluster; ++k) {
        if (k >= parts) break;
        const frames::root_test test = near_part[k];
#pragma unroll
        for (int j = 0; j < quad; ++j) near_pairs |= unsigned(passes(test, j)) << (quad * k + j);
      }

#pragma unroll
      for (int j = 0; j < quad; ++j)
        if ((p.reasons >> 8 * j & 0xff) != 0) near_pairs &= ~(0x11111111u << j);
      near_pairs &= left.pairs;
      if (near_pairs != 0) near_pairs = pairs::add(near_pairs, p, first(), c * cluster);
      if (__any_sync(all_lanes, near_pairs != 0)) {
        left = {c + 1, near_pairs};
        return false;
      }
    }
    left.pairs = ~0u;
  }
  left.clusters = 0;
  return true;
}

}  // namespace clearance::scan
