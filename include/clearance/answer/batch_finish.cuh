// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/answer/batch_arguments.hpp>
#include <clearance/answer/beyond.hpp>
#include <clearance/answer/resolve.hpp>
#include <clearance/scan/threads.cuh>

namespace clearance::minimum {

/// The witness of each configuration's minimum, if it is a point of this cloud; after the last cloud all of its result. A warp a
/// configuration, whose lanes look for the part.
template <class PartView, class Question, class Source>
__global__ void __launch_bounds__(128) finish_configurations(const __grid_constant__ batch_arguments<PartView, Question> a,
                                                             const __grid_constant__ Source source) {
  const std::uint32_t c = (blockIdx.x * 128 + threadIdx.x) / 32, lane = threadIdx.x % 32;
  if (c >= a.configurations) return;
  const configuration_facts& facts = a.facts[c];
  const shared_bounds bounds{a.all + c, nullptr};
  for (std::uint32_t first = 0; first < a.part_count; first += 32) {
    const std::uint32_t k = first + lane;
    min_distance_result mine;
    if (k < a.part_count)
      resolve_body<PartView, Source, any_depth>{a.parts + k,   a.its_places(c) + k, 1,      source, facts.origin, facts.world_from_cloud, a.now.first,
                                                a.now.cloud, bounds,              {},     &mine,  nullptr}(1);
    const unsigned those = __ballot_sync(scan::all_lanes, mine.part != none);
    if (those == 0) continue;
    if (int(lane) == __ffs(int(those)) - 1) mine.part = k, a.results[c] = mine;
    break;
  }
  __syncwarp();
  if (!a.now.last || lane != 0) return;
  min_distance_result r = a.results[c];
  conclude_body<PartView>{a.parts, a.part_count, a.dropped, bounds, facts.error, facts.slop, a.seen, &r}(0);
  beyond(r, a.question.d_max, facts.slop, facts.error);
  if (!facts.rigid) r.state = state::possible, r.distance = not_a_number, r.lower = 0, r.upper = infinity;
  a.results[c] = r;
  a.last[c] = {r.cloud, r.point};
}

/// What margins leave of each, after the last cloud.
template <class PartView, class Question>
__global__ void __launch_bounds__(128) tell_configurations(const __grid_constant__ batch_arguments<PartView, Question> a) {
  const std::uint32_t c = blockIdx.x * 128 + threadIdx.x;
  if (c >= a.configurations) return;
  point_counts counts;
  scan::count(counts, a.dropped->dropped, a.seen);
  a.results[c] = a.facts[c].rigid ? Question::told(a.all[c], counts.valid, counts.dropped[int(drop_reason::too_close)] != 0) : state::possible;
}

}  // namespace clearance::minimum
