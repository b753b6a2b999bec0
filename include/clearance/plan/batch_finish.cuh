// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/minimum/beyond.hpp>
#include <clearance/minimum/resolve.hpp>
#include <clearance/plan/batch_arguments.hpp>
#include <clearance/plan/batch_walk.cuh>
#include <clearance/scan/threads.cuh>

namespace clearance::minimum {

/// Writes the witness of each configuration's minimum, if it is a point of this cloud; after the last cloud, the whole
/// result. One warp per configuration: each lane tests one part, and all lanes look for the primitive together.
template <class PartView, class Question, class Source>
__global__ void __launch_bounds__(128)
    finish_configurations(const __grid_constant__ batch_arguments<PartView, Question> a,
                          const __grid_constant__ Source source) {
  constexpr bool balls = ball_source<Source>;  // each lane walks for the ball, and all find the same
  using walk_type = std::conditional_t<balls, any_depth, walk_by_warp<typename PartView::hierarchy_type>>;
  using steps = warp_walk<typename PartView::hierarchy_type>;
  __shared__ typename steps::node_type pending[4][steps::most];
  const std::uint32_t c = (blockIdx.x * 128 + threadIdx.x) / 32, lane = threadIdx.x % 32;
  if (c >= a.configurations) return;
  const PartView* const parts = a.its_parts(c);
  const configuration_facts& facts = a.facts[c];
  const shared_bounds bounds{a.all + c, nullptr};
  min_distance_result mine;
  walk_type walk{};
  if constexpr (!balls) walk = {{pending[threadIdx.x / 32]}};
  const auto of_part = [&](std::uint32_t k) -> resolve_body<PartView, Source, walk_type> {
    return {parts + k,   a.its_places(c) + k, 1,      source, facts.origin, facts.world_from_cloud,
            a.now.first, a.now.cloud,         bounds, walk,   &mine,        nullptr};
  };
  for (std::uint32_t first = 0; first < a.part_count && __all_sync(scan::all_lanes, mine.part == none); first += 32) {
    unsigned those = __ballot_sync(scan::all_lanes, first + lane < a.part_count && of_part(first + lane).may_be_of(0));
    for (; those != 0 && __all_sync(scan::all_lanes, mine.part == none); those &= those - 1) {
      const std::uint32_t k = first + std::uint32_t(__ffs(int(those))) - 1;
      of_part(k)(1);
      if (mine.part != none) mine.part = k;
      if (mine.part != none && (!balls || lane == 0)) a.results[c] = mine;
    }
  }
  __syncwarp();
  if (!a.now.last || lane != 0) return;
  min_distance_result r = a.results[c];
  conclude_body<PartView>{parts, a.part_count, a.dropped, bounds, facts.error, facts.slop, a.seen, &r}(0);
  beyond(r, a.question.d_max, facts.slop, facts.error);
  if (!facts.rigid) r.state = state::possible, r.distance = not_a_number, r.lower = 0, r.upper = infinity;
  if (r.part != none) r.part += a.first_part(c);
  a.results[c] = r;
  a.last[c] = {r.cloud, r.point};
}

/// Writes the state of each configuration after the last cloud, for a question by margins.
template <class PartView, class Question>
__global__ void __launch_bounds__(128)
    tell_configurations(const __grid_constant__ batch_arguments<PartView, Question> a) {
  const std::uint32_t c = blockIdx.x * 128 + threadIdx.x;
  if (c >= a.configurations) return;
  point_counts counts;
  scan::count(counts, a.dropped->dropped, a.seen);
  a.results[c] = a.facts[c].rigid
                     ? Question::told(a.all[c], counts.valid, counts.dropped[int(drop_reason::too_close)] != 0)
                     : state::possible;
}

}  // namespace clearance::minimum
