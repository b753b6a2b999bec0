// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Takes many pairs of a point and a part down to one leaf each, a thread per pair. That leaf is nearly always enough.

#include <clearance/ground/ordered.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/team.cuh>

namespace clearance::scan {

template <class Tally>
struct leaf_first : tree_steps<Tally> {
  using frame = frame_parts<Tally>;
  using steps = tree_steps<Tally>;

  /// All pairs of the table go down greedily at once, with eight, four, two or one lanes per pair: the fewer pairs, the
  /// more lanes. A pair is done if everything that it passed by is too far away to matter. The others are left open,
  /// with a bound for their walk. The whole block calls it.
  static __device__ void go(std::uint32_t count) {
    auto& s = frame::here();
    if (count <= Tally::few) {
      for (std::uint32_t i = threadIdx.x; i < count; i += block_threads) Tally::leave_open(s, i);
    } else {
      if (count <= block_threads / 8)
        go_as<lanes<8>>(count);
      else if (count <= block_threads / 4)
        go_as<lanes<4>>(count);
      else if (count <= block_threads / 2)
        go_as<lanes<2>>(count);
      else
        go_as<alone>(count);
      __syncthreads();  // only now: the test needs the least distances over all pairs
      for (std::uint32_t i = threadIdx.x; i < count; i += block_threads)
        if (passed_by(i) <= Tally::reach_of_pair(s, s.part_of_pair[i], i)) Tally::leave_open(s, i);
    }
    __syncthreads();
  }

 private:
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
      live = live && !Tally::skips(s, part, c.point, i, c.x);
      live = team.first(!live) < 0;  // others may be changing its inputs
      const vec3 q = frame::place(part).part_from_cloud(c.x);
      nearest_passed others{Tally::reach_of_part(s, part, 0)};
      bool found = live;
      const typename steps::node_type leaf = nearest_leaf(steps_of_part<Tally>{part}, q, found, team, others);
      const std::uint32_t size = found ? steps::size(part, leaf) : 0;
      distance_key best = no_key;
#pragma unroll 1
      for (std::uint32_t k = team.rank(); k < size; k += Team::size) {
        const auto place = steps::place_of(leaf, k);
        const real distance = steps::primitive(part, place).distance(q);
        if (const distance_key key = make_key(distance, steps::id(part, place)); key < best) best = key;
      }
      if (live && key_distance(best) <= Tally::reach_of_part(s, part, 0)) Tally::hear(s, part, i, best);
      const real passed = team.least(others.bound);
      if (i < count && team.rank() == 0)
        passed_by(i) = !live ? not_a_number : has_interior<typename Tally::part_type> ? -infinity : passed;
    }
  }

  /// A lower bound on what pair `i` has passed by. It is minus infinity if the part has a solid: everything is still to
  /// be found. It lies in the stacks, which no warp uses yet.
  static __device__ real& passed_by(std::uint32_t i) {
    auto& s = frame::here();
    static_assert(pair_capacity <= warps * stack_capacity);
    return s.stack[i / stack_capacity][i % stack_capacity].bound;
  }
};

}  // namespace clearance::scan
