// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/plan/batch_arguments.hpp>
#include <clearance/scan/threads.cuh>

namespace clearance::minimum {

/// So many lanes place a configuration. A few for each of several parts were slower than a warp.
CLEARANCE_HD constexpr std::uint32_t placing_lanes(std::uint32_t parts) { return parts == 1 ? 1 : 32; }

/// Does what a host does with poses before a search, and finds where each search begins. A warp per
/// configuration, or a lane if that has one part.
template <class PartView, class Question, class Source>
__global__ void __launch_bounds__(128)
    place_configurations(const __grid_constant__ batch_arguments<PartView, Question> a,
                         const __grid_constant__ Source source) {
  const std::uint32_t lanes = placing_lanes(a.part_count), c = (blockIdx.x * 128 + threadIdx.x) / lanes,
                      lane = threadIdx.x % lanes, first = threadIdx.x % 32 - lane;
  const unsigned team = (scan::all_lanes >> (32 - lanes)) << first;
  if (c >= a.configurations) return;
  if (c == 0 && lane == 0) a.left.used[0] = a.left.used[1] = 0;
  const PartView* const parts = a.its_parts(c);
  frames::placement* const places = a.its_places(c);
  bool rigid = true;
  for (std::uint32_t k = lane; k < a.part_count; k += lanes) {
    const std::size_t which = std::size_t(c) * a.part_count + k;
    world_transform pose = a.poses[which];
    if (!make_rigid(pose)) {
      rigid = false, pose = {};
      *static_cast<volatile std::uint32_t*>(a.lost) = 1;
    }
    places[k].world_from_part = pose;
  }
  rigid = __all_sync(team, rigid);
  __syncwarp(team);
  configuration_facts facts(a.world_from_cloud, {0, 0, 0}, a.off);
  if (lane == 0) {
    const auto pose = [places](std::uint32_t k) -> const world_transform& { return places[k].world_from_part; };
    facts.origin = frames::origin_near(frames::middle_of(a.world_from_cloud, pose, a.part_count));
  }
  facts.origin = scan::from_lane(facts.origin, int(first), team);
  for (std::uint32_t k = lane; k < a.part_count; k += lanes) {
    const frames::placement here =
        frames::place(parts[k].facts, places[k].world_from_part, a.world_from_cloud, facts.origin, a.off);
    places[k] = here;
    a.bounds[std::size_t(c) * a.part_count + k] = ball_bounds(parts[k].facts, here.part_from_cloud);
  }
  __syncwarp(team);
  for (std::uint32_t k = 0; k < a.part_count; ++k) facts.add(parts[k].facts, places[k].error);
  facts.rigid = rigid;
  if (a.now.cloud != 0 || a.foreseen) facts.error.widen(a.facts[c].error);  // a bracket covers all clouds
  if constexpr (Question::by_margin)
    for (std::uint32_t k = lane; k < a.part_count; k += lanes)
      a.near[std::size_t(c) * a.part_count + k] = a.question.near(k, parts[k].facts, facts.error);
  __syncwarp(team);
  if (lane != 0) return;
  if (a.now.cloud == 0) a.all[c] = a.question.start(rigid);
  a.facts[c] = facts;
  if constexpr (!Question::by_margin) {
    if (a.now.cloud == 0) a.results[c] = {};
    cloud_tree::numbered_point seed{{0, 0, 0}, none};
    if (const last_place last = a.last[c]; last.cloud == a.now.cloud && last.point < source.size())
      if (const sample s = source[last.point]; s.valid()) seed = {s.position, last.point};
    a.seeds[c] = seed;
  }
}

}  // namespace clearance::minimum
