// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Many pairs of a point and a part, a thread each: down to one leaf, which nearly always says enough.

#include <clearance/ground/ordered.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/team.cuh>

namespace clearance::scan {

template <class Answer>
struct leaf_first : tree_steps<Answer> {
  using frame = frame_parts<Answer>;
  using steps = tree_steps<Answer>;

  /// All pairs of the table go down greedily: a lane each, or eight lanes each if there are few, as one lane would take longer than all
  /// the rest. If whatever they have passed by on their way is too far to matter, they are done; the others are left open, with a bound
  /// for their walk. The whole block calls it.
  static __device__ void go(std::uint32_t count) {
    if (count <= Answer::few)
      for (std::uint32_t i = threadIdx.x; i < count; i += block_threads) Answer::leave_open(frame::here(), i);
    else if (count <= few)
      go_as<eight_lanes>(count);
    else
      go_as<alone>(count);
    __syncthreads();
  }

 private:
  static constexpr std::uint32_t few = 8 * warps;

  template <class Team>
  static __device__ void go_as(std::uint32_t count) {
    auto& s = frame::here();
    const Team team;
#pragma unroll 1
    for (std::uint32_t begin = 0; begin < count; begin += block_threads / Team::size) {
      const std::uint32_t i = begin + threadIdx.x / Team::size;
      bool live = i < count;
      const pair c = live ? s.pair_table[i] : pair{};
      const std::uint32_t part = live ? s.part_of_pair[i] : 0;
      live = live && !Answer::skips(s, part, c.point, i, c.x);
      live = team.first(!live) < 0;  // others may be changing what decides it
      const vec3 q = frame::place(part).part_from_cloud(c.x);
      nearest_passed others{Answer::reach_of_part(s, part, 0)};
      bool found = live;
      const typename steps::node_type leaf = nearest_leaf(steps_of_part<Answer>{part}, q, found, team, others);
      const std::uint32_t size = found ? steps::size(part, leaf) : 0;
      distance_key best = no_key;
#pragma unroll 1
      for (std::uint32_t k = team.rank(); k < size; k += Team::size) {
        const auto place = steps::place_of(leaf, k);
        const real distance = steps::primitive(part, place).distance(q);
        if (const distance_key key = make_key(distance, steps::id(part, place)); key < best) best = key;
      }
      if (live && key_distance(best) <= Answer::reach_of_part(s, part, 0)) Answer::hear(s, part, i, best);
      const real passed = team.least(others.bound);
      __syncwarp();  // all of a team have been heard
      // A point in a solid has yet to be found there.
      if (live && team.rank() == 0 && (has_interior<typename Answer::part_type> || passed <= Answer::reach_of_pair(s, part, i))) Answer::leave_open(s, i);
    }
  }
};

}  // namespace clearance::scan
