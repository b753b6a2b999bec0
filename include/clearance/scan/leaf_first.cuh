// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Takes many pairs of a point and a part down to one leaf each, a thread per pair. That leaf is nearly always enough.
// A part's field, if there is one, decides most pairs before.

#include <clearance/ground/ordered.hpp>
#include <clearance/result.hpp>
#include <clearance/robot/cells.hpp>
#include <clearance/robot/field.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/team.cuh>

namespace clearance::scan {

template <class Tally>
struct leaf_first : tree_steps<Tally> {
  using frame = frame_parts<Tally>;
  using steps = tree_steps<Tally>;

  /// All pairs of the table go down greedily at once, with eight, four, two or one lanes per pair: the fewer pairs, the
  /// more lanes. A pair is done if everything that it passed by is too far away to matter. The others are left open,
  /// with a bound for their walk. If parts have fields, only those pairs go down that these do not decide; if parts
  /// have cells, none. The whole block calls it.
  static __device__ void go(std::uint32_t count) {
    auto& s = frame::here();
    if (const field_view* const fields = Tally::fields(s); fields != nullptr) {
      go_by_field(count, fields);
    } else if (count <= Tally::few || has_cells<typename Tally::part_type>) {
      for (std::uint32_t i = threadIdx.x; i < count; i += block_threads) Tally::leave_open(s, i);
    } else {
      const auto every = [](std::uint32_t n) { return n; };
      if (count <= block_threads / 8)
        go_as<lanes<8>>(count, every);
      else if (count <= block_threads / 4)
        go_as<lanes<4>>(count, every);
      else if (count <= block_threads / 2)
        go_as<lanes<2>>(count, every);
      else
        go_as<alone>(count, every);
      __syncthreads();  // only now: the test needs the least distances over all pairs
      for (std::uint32_t i = threadIdx.x; i < count; i += block_threads)
        if (may_matter(i)) Tally::leave_open(s, i);
    }
    __syncthreads();
  }

 private:
  /// May what the pair passed by still matter to it?
  static __device__ bool may_matter(std::uint32_t i) {
    auto& s = frame::here();
    return passed_by(i) <= Tally::reach_of_pair(s, s.part_of_pair[i], i);
  }

  /// Not inlined, so that it costs those nothing that have no fields.
  static __noinline__ __device__ void go_by_field(std::uint32_t count, const field_view* fields) {
    static_assert(pair_capacity <= 2 * block_threads);
    auto& s = frame::here();
    const std::uint32_t t = threadIdx.x;
    for (std::uint32_t i = t; i < count; i += block_threads) foresee(i, fields);
    __syncthreads();
    for (std::uint32_t i = t; i < count; i += block_threads)
      if (may_matter(i)) Tally::leave_open(s, i);
    __syncthreads();
    const std::uint32_t left = Tally::open_pairs(s);
    if (left <= Tally::few_left || has_cells<typename Tally::part_type>) return;
    const auto open = [&](std::uint32_t n) { return Tally::open_pair(s, n); };
    if (left <= block_threads / 8)
      go_as<lanes<8>>(left, open);
    else if (left <= block_threads / 4)
      go_as<lanes<4>>(left, open);
    else
      go_as<lanes<2>>(left, open);
    std::uint32_t mine[2];
    for (std::uint32_t k = 0; k < 2; ++k) mine[k] = t + k * block_threads < left ? open(t + k * block_threads) : none;
    __syncthreads();
    if (t == 0) Tally::close_all(s);
    __syncthreads();
    for (const std::uint32_t i : mine)
      if (i != none && may_matter(i)) Tally::leave_open(s, i);
  }

  /// What a field tells of a pair: an upper bound as if a primitive were there, and a lower one as if the rest were
  /// passed by. Of a point that may be in a part's solid nothing is passed by.
  static __device__ void foresee(std::uint32_t i, const field_view* fields) {
    auto& s = frame::here();
    const pair c = s.pair_table[i];
    const std::uint32_t part = s.part_of_pair[i];
    real& passed = passed_by(i) = not_a_number;
    if (Tally::skips(s, part, c.point, i, c.x)) return;
    const field_range its = fields[part](frame::place(part).part_from_cloud(c.x));
    const bool outside = !has_interior<typename Tally::part_type> || its.side == field_side::outside;
    passed = outside ? its.low : -infinity;
    Tally::hear_bound(s, part, i, its.high);
  }

  template <class Team, class PairOf>
  static __device__ void go_as(std::uint32_t count, const PairOf& pair_of) {
    auto& s = frame::here();
    const Team team;
#pragma unroll 1
    for (std::uint32_t begin = 0; begin < count; begin += block_threads / Team::size) {
      bool live = begin + threadIdx.x / Team::size < count;
      const std::uint32_t i = live ? pair_of(begin + threadIdx.x / Team::size) : 0;
      const pair c = live ? s.pair_table[i] : pair{};
      const std::uint32_t part = live ? s.part_of_pair[i] : 0;
      const bool asked = live;
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
      if (asked && team.rank() == 0)
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
