// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The search of many configurations by the parts' fields, on a device.

#include <clearance/plan/batch_kernel.cuh>
#include <clearance/plan/field_search.hpp>

namespace clearance::minimum {

/// The exact search of what a field search has set aside: points with the parts that they may be near to.
template <class Search>
struct search_aside : Search {
  const field_pair* points;
  std::uint32_t count;

  CLEARANCE_HD std::uint32_t starts() const { return count; }
  CLEARANCE_HD bool start(std::uint32_t i, typename Search::pair& p) const {
    const field_pair& its = points[i];
    if (!(its.bound <= Search::reach(its.part)) || !Search::start_at(its.at, its.part, its.whole, p)) return false;
    p.bound = max(p.bound, its.bound);
    return true;
  }
};

/// Shared memory of a block: a field search's stack, an exact one's, what both have made in a round, and the points set
/// aside.
template <class PartView>
struct field_room {
  using tree_pair = node_pair<typename PartView::hierarchy_type::node_type>;
  using by_field = batch_room<field_pair, pair_order<PartView>>;
  using exact = batch_room<tree_pair, pair_order<PartView>>;

  static constexpr std::uint32_t depth(std::uint32_t threads) { return 256 + 2 * threads; }
  static constexpr std::size_t bytes(std::uint32_t threads) {
    return exact::bytes(threads, depth(threads)) + depth(threads) * sizeof(field_pair) + threads * sizeof(field_pair);
  }
};

/// One block per configuration, as batch_kernel.
template <class Arguments, class Tree>
__global__ void __launch_bounds__(256, 4)
    field_kernel(const __grid_constant__ Arguments a, const __grid_constant__ Tree tree) {
  static_assert(Tree::fan <= 8 && Tree::tile <= 8, "one lane a child");
  using question = typename Arguments::question_type;
  using memory_type = typename Arguments::memory_type;
  using body_type = typename Arguments::body_type;
  using room = field_room<typename Arguments::part_type>;
  using search_type = field_search<body_type, Tree>;
  using exact_type = search_aside<tree_search<body_type, Tree>>;
  using block_type = block_search<search_type>;
  using exact_block = block_search<exact_type>;
  extern __shared__ distance_key memory[];
  __shared__ alignas(memory_type) std::byte memory_of_best[sizeof(memory_type)];
  __shared__ typename block_type::words words;
  __shared__ typename exact_block::words exact_words;
  memory_type& best = *reinterpret_cast<memory_type*>(memory_of_best);
  const std::uint32_t t = threadIdx.x, depth = room::depth(blockDim.x);
  field_pair* const stack = reinterpret_cast<field_pair*>(memory);
  field_pair* const aside = stack + depth;
  distance_key* const others = reinterpret_cast<distance_key*>(aside + blockDim.x);
  const typename room::exact exact_room(others, blockDim.x, depth);
  typename room::by_field field_room_of(others, blockDim.x, depth);
  field_room_of.stack = stack;  // the pairs that it makes lie where the exact search has its own
  field_room_of.made = reinterpret_cast<field_pair*>(exact_room.stack + depth);
  for (std::uint32_t i = blockIdx.x, count = a.given.pieces != nullptr ? a.given.size() : a.configurations; i < count;
       i += gridDim.x) {
    const std::uint32_t c = a.given.pieces != nullptr ? a.given.pieces[i].configuration : i;
    if (!a.facts[c].rigid) continue;
    if (t == 0) best = a.all[c];
    __syncthreads();
    const body_type body = a.body(c, &best);
    const ball_bounds* const bounds = a.bounds + std::size_t(c) * a.part_count;
    const search_type search{body, tree, bounds, a.fields};
    block_type block{search, field_room_of, words, depth, aside};
    if (a.given.pieces != nullptr) {
      block.start(a.given.pieces[i]);
    } else {
      if constexpr (!question::by_margin)
        for (std::uint32_t j = t; j < 3 * a.part_count; j += blockDim.x)  // its own last minimum and its neighbours'
          if (const std::uint32_t from = c + j / a.part_count - 1; from < a.configurations)
            if (const auto seed = a.seeds[from]; seed.number != none) search.seed(seed, j % a.part_count);
      block.start();
    }
    for (std::uint32_t rounds = a.rounds;;) {
      const bool done = block.go_on(rounds);
      if (block.aside != 0) {
        const exact_type exact{{body, tree, bounds}, aside, block.aside};
        exact_block rest{exact, exact_room, exact_words, depth};
        rest.start();
        rest.go_on(none);
        block.taken();
      }
      if (done) break;
      if (block.round >= rounds && block.next >= search.starts()) {
        if (block.count == 0 || block.leave_to(a.left, c)) break;
        rounds = none;
      }
    }
    __syncthreads();
    if (t != 0) continue;
    if (a.given.pieces != nullptr)
      question::add(a.all + c, best);
    else
      a.all[c] = best;
  }
}

}  // namespace clearance::minimum
