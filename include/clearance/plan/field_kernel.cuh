// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The search of many configurations by the parts' fields, on a device.

#include <clearance/plan/batch_kernel.cuh>
#include <clearance/plan/field_search.hpp>

namespace clearance::plan {

/// Shared memory of a block: a search's stack and what it makes in a round, the points that it has set aside and their
/// order, and each warp's nodes of an exact walk.
template <class PartView>
struct field_room {
  using walk_type = warp_walk<typename PartView::hierarchy_type>;
  using node_type = typename walk_type::node_type;
  using stack_type = batch_room<field_pair, pair_order<PartView>>;

  static constexpr std::uint32_t depth(std::uint32_t threads) { return 256 + 2 * threads; }
  static constexpr std::size_t bytes(std::uint32_t threads) {
    return stack_type::bytes(threads, depth(threads)) + threads * (sizeof(field_pair) + sizeof(std::uint32_t)) +
           threads / 32 * walk_type::most * sizeof(node_type) + alignof(node_type);
  }

  stack_type stack;
  field_pair* aside;
  std::uint32_t* order;
  node_type* nodes;

  __device__ field_room(distance_key* memory, std::uint32_t threads)
      : stack(memory, threads, depth(threads)),
        aside(stack.made + stack_type::most(threads)),
        order(reinterpret_cast<std::uint32_t*>(aside + threads)),
        nodes(
            reinterpret_cast<node_type*>((reinterpret_cast<std::uintptr_t>(order + threads) + alignof(node_type) - 1) /
                                         alignof(node_type) * alignof(node_type))) {}
};

/// Looks exactly at the points that a search has set aside: those that may be inside a solid by a thread each, and the
/// others, the nearest first, by a warp that walks the part's tree.
template <class Search, class Room>
__device__ void look_at(const Search& search, const Room& room, std::uint32_t count) {
  const std::uint32_t t = threadIdx.x;
  if (t < count) {
    std::uint32_t before = 0;
    for (std::uint32_t j = 0; j < count; ++j)
      before += room.aside[j].bound < room.aside[t].bound || (room.aside[j].bound == room.aside[t].bound && j < t);
    room.order[before] = t;
    if (const field_pair& its = room.aside[t]; Search::solid && its.whole && !search.settled(its))
      search.visit(search.tree.point(its.at), its.part);
  }
  __syncthreads();
  const typename Room::walk_type walk{room.nodes + t / 32 * Room::walk_type::most};
  for (std::uint32_t i = t / 32; i < count; i += blockDim.x / 32) {
    const field_pair p = room.aside[room.order[i]];
    if (Search::solid && p.whole) continue;
    if (__any_sync(scan::all_lanes, search.settled(p))) continue;
    const auto here = search.tree.point(p.at);
    const auto& body = search.body;
    const std::uint32_t index = body.first + here.number;
    auto ask = body.answer.visitor(index, p.part);
    const real reach = scan::from_lane(body.answer.reach(p.part), 0);
    walk(body.parts[p.part].tree, scan::moved(body.places[p.part].part_from_cloud, element_less(here, body.origin)),
         reach, ask);
    body.answer.take(index, p.part, ask);
  }
}

/// One block per configuration, as batch_kernel.
template <class Arguments, class Tree>
__global__ void __launch_bounds__(256, 4)
    field_kernel(const __grid_constant__ Arguments a, const __grid_constant__ Tree tree) {
  static_assert(Tree::fan <= 8 && Tree::tile <= 8, "one lane a child");
  using question = typename Arguments::question_type;
  using memory_type = typename Arguments::memory_type;
  using body_type = typename Arguments::body_type;
  using room_type = field_room<typename Arguments::part_type>;
  using search_type = field_search<body_type, Tree>;
  using block_type = block_search<search_type>;
  extern __shared__ distance_key memory[];
  __shared__ alignas(memory_type) std::byte memory_of_best[sizeof(memory_type)];
  __shared__ typename block_type::words words;
  memory_type& best = *reinterpret_cast<memory_type*>(memory_of_best);
  const std::uint32_t t = threadIdx.x;
  const room_type room(memory, blockDim.x);
  for (std::uint32_t i = blockIdx.x, count = a.given.pieces != nullptr ? a.given.size() : a.configurations; i < count;
       i += gridDim.x) {
    const std::uint32_t c = a.given.pieces != nullptr ? a.given.pieces[i].configuration : i;
    if (!a.facts[c].rigid) continue;
    if (t == 0) best = a.all[c];
    __syncthreads();
    const body_type body = a.body(c, &best);
    const search_type search{body, tree, a.bounds + std::size_t(c) * a.part_count, a.fields + a.first_part(c),
                             searched_levels(tree, a.part_count, blockDim.x)};
    block_type block{search, room.stack, words, room_type::depth(blockDim.x), room.aside};
    if (a.given.pieces != nullptr) {
      block.start(a.given.pieces[i]);
    } else {
      if constexpr (!question::by_margin)
        for (std::uint32_t j = t; j < 3 * a.part_count; j += blockDim.x)
          if (const auto seed = a.seed(c, j); seed.number != none) search.seed(seed, j % a.part_count);
      block.start();
    }
    for (std::uint32_t rounds = a.rounds;;) {
      const bool done = block.go_on(rounds);
      if (block.aside != 0) look_at(search, room, block.aside), block.taken();
      if (done) break;
      if (block.round < rounds || block.next < search.starts()) continue;
      if (block.count == 0 || block.leave_to(a.left, c)) break;
      rounds = none;
    }
    __syncthreads();
    if (t != 0) continue;
    if (a.given.pieces != nullptr)
      question::add(a.all + c, best);
    else
      a.all[c] = best;
  }
}

}  // namespace clearance::plan
