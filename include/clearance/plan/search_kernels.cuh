// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The kernels that search for many configurations on a device, one block for each, by trees of parts or by fields.

#include <clearance/minimum/warp_walk.cuh>
#include <clearance/plan/tree_search.hpp>

#include <type_traits>

namespace clearance::plan {

/// Pairs that blocks have left to other blocks. Each piece belongs to one configuration.
template <class Pair>
struct batch_pieces {
  static constexpr std::uint32_t most = 16;
  struct piece {
    std::uint32_t configuration, count;
    Pair pairs[most];
  };
  piece* pieces = nullptr;
  std::uint32_t* used = nullptr;  ///< How many pieces were asked for.
  std::uint32_t capacity = 0;     ///< How many there are.

  CLEARANCE_HD std::uint32_t size() const { return *used < capacity ? *used : capacity; }
};

/// Shared memory of a block: the pairs that are still to be opened, the nearest on top, and the pairs that a round has
/// made.
template <class Pair, class Order>
struct batch_room {
  static constexpr std::uint32_t lanes = 8;  ///< So many lanes open a pair together, one child per lane.

  Order* orders;  ///< Of the pairs in `made`.
  Pair *stack, *made;

  /// Room kept free on the stack: within it, pairs are opened one at a time, down to the last level.
  static constexpr std::uint32_t reserve = 128;
  CLEARANCE_HD static constexpr std::uint32_t least_depth(std::uint32_t threads) { return 512 + threads; }
  /// A pair that has more children than lanes is itself made again, in addition to the children.
  CLEARANCE_HD static constexpr std::uint32_t most(std::uint32_t threads) { return threads + threads / lanes; }
  static constexpr std::size_t bytes(std::uint32_t threads, std::uint32_t depth) {
    return most(threads) * (sizeof(distance_key) + sizeof(Pair)) + depth * sizeof(Pair);
  }
  /// How deep the stack may be if a block has `all` bytes.
  static constexpr std::uint32_t depth(std::uint32_t threads, std::size_t all) {
    const std::size_t others = bytes(threads, 0), least = least_depth(threads);
    return std::uint32_t(all < others + least * sizeof(Pair) ? least : (all - others) / sizeof(Pair));
  }
  __device__ batch_room(distance_key* memory, std::uint32_t threads, std::uint32_t depth)
      : orders(reinterpret_cast<Order*>(memory)),
        stack(reinterpret_cast<Pair*>(memory + most(threads))),
        made(stack + depth) {}
};

/// One configuration's search by a block. In every round it opens the nearest pairs of its stack, eight lanes per pair,
/// and puts the new pairs back in order. The order matters, because an early find prunes the others.
template <class Search>
struct block_search {
  using search_type = Search;
  using pair = typename Search::pair;
  using room_type = batch_room<pair, typename Search::order_type>;
  using pieces_type = batch_pieces<pair>;
  static constexpr std::uint32_t lanes = room_type::lanes;

  /// Words that all of its threads share.
  struct words {
    std::uint32_t made[2];  ///< Number of pairs made in this round and in the next.
    std::uint32_t first;    ///< The first piece that the stack is left in.
    std::uint32_t aside;    ///< Number of pairs set aside.
  };

  const Search& search;
  const room_type room;
  words& shared;
  const std::uint32_t depth;        ///< Of the stack.
  pair* const set_aside = nullptr;  ///< If not null: room for as many points as there are threads, for another search.
  std::uint32_t count = 0, round = 0, next = 0, aside = 0;
  const std::uint32_t t = threadIdx.x, threads = blockDim.x;

  /// Begins with a configuration, or with a piece of it that another block has left. If `Seeds`, what is known to be
  /// near is looked at first.
  template <bool Seeds, class Arguments>
  __device__ void begin(const Arguments& a, std::uint32_t configuration, std::uint32_t piece) {
    if (a.given.pieces != nullptr) {
      const auto& left = a.given.pieces[piece];
      count = left.count;
      next = search.starts();
      if (t < count) room.stack[t] = left.pairs[t];
    } else if constexpr (Seeds) {
      for (std::uint32_t j = t; j < 3 * a.part_count; j += threads)
        if (const auto seed = a.seed(configuration, j); seed.number != none) search.seed(seed, j % a.part_count);
    }
    if (t == 0) shared.made[0] = shared.made[1] = shared.aside = 0;
    __syncthreads();
  }
  /// All points that were set aside have been looked at.
  __device__ void taken() {
    __syncthreads();
    if (t == 0) shared.aside = 0;
    aside = 0;
    __syncthreads();
  }

  /// Returns true when nothing is left, and false after `rounds` rounds, or when the room for what is set aside is half
  /// full.
  __device__ bool go_on(std::uint32_t rounds) {
    for (const std::uint32_t starts = search.starts(); next < starts || count > 0;) {
      if (set_aside != nullptr && 2 * aside >= threads) return false;
      if (count == 0) {
        pair p;
        if (next + t < starts && search.start(next + t, p)) make(p);
        next += threads;
        put_back(0);
        continue;
      }
      if (round >= rounds && next >= starts) return false;
      const std::uint32_t left = depth - count,
                          many = left > room_type::reserve ? (left - room_type::reserve) / (lanes + 1) : 0;
      const std::uint32_t take = scan::lower_of(scan::lower_of(threads / lanes, count), many > 0 ? many : left > lanes);
      if (take == 0) {
        const pair top = room.stack[count - 1];
        visit_all(top);
        put_back(1);
        continue;
      }
      if (t / lanes < take) open(room.stack[count - 1 - t / lanes]);
      put_back(take);
    }
    return true;
  }

  /// Leaves the stack to other blocks, dealt out so that each piece gets some of the nearest pairs. Returns false if
  /// there is no room.
  __device__ bool leave_to(const pieces_type& others, std::uint32_t configuration) {
    const std::uint32_t pieces = (count - 1) / pieces_type::most + 1;
    if (t == 0) shared.first = atomicAdd(others.used, pieces);
    __syncthreads();
    const std::uint32_t first = shared.first;
    const bool fits = first < others.capacity && others.capacity - first >= pieces;
    for (std::uint32_t i = t; i < pieces && first + i < others.capacity; i += threads) {
      others.pieces[first + i].configuration = configuration;
      others.pieces[first + i].count = fits ? (count - 1 - i) / pieces + 1 : 0;
    }
    if (fits)
      for (std::uint32_t i = t; i < count; i += threads)
        others.pieces[first + i % pieces].pairs[i / pieces] = room.stack[i];
    return fits;
  }

 private:
  __device__ void make(const pair& p) {
    if (set_aside != nullptr && p.level == 0)
      if (const std::uint32_t i = atomicAdd(&shared.aside, 1u); i < threads) {
        set_aside[i] = p;
        return;
      }
    const std::uint32_t at = atomicAdd(&shared.made[round % 2], 1u);
    room.made[at] = p;
    room.orders[at] = search.order(p);
  }

  /// One child per lane.
  __device__ void open(const pair top) {
    if (search.settled(top)) return;
    const std::uint32_t lane = t % lanes, size = search.children(top);
    pair p;
    if constexpr (requires { top.from; }) {
      if (top.from + lane < size && search.child(top, top.from + lane, p)) make(p);
      if (lane == 0 && top.from + lanes < size) {
        p = top;
        p.from += lanes;
        make(p);
      }
    } else {
      if (lane < size && search.child(top, lane, p)) make(p);  // a cloud's tree has no more
    }
  }
  /// For a pair whose children have no room on the stack: visits all its points at once.
  __device__ void visit_all(const pair& p) const {
    using tree_type = std::remove_cvref_t<decltype(search.tree)>;
    std::uint64_t begin = p.at, end = p.at + 1;
    for (std::uint32_t l = 0; l < p.level; ++l) {
      begin *= l == 0 ? tree_type::tile : tree_type::fan;
      end *= l == 0 ? tree_type::tile : tree_type::fan;
    }
    end = end < search.tree.count ? end : search.tree.count;
    for (begin += t; begin < end; begin += threads) search.visit(search.tree.point(std::uint32_t(begin)), p.part);
  }

  /// Replaces the stack's last `taken` pairs by the pairs that were made of them, the nearest on top.
  __device__ void put_back(std::uint32_t taken) {
    __syncthreads();
    const std::uint32_t n = shared.made[round % 2];
    if (set_aside != nullptr) aside = scan::lower_of(shared.aside, threads);
    if (t == 0) shared.made[(round + 1) % 2] = 0;
    count -= taken;
    for (std::uint32_t i = t; i < n; i += threads) {
      const auto mine = room.orders[i];
      std::uint32_t below = 0;
      for (std::uint32_t j = 0; j < n; ++j) below += room.orders[j] > mine || (room.orders[j] == mine && j > i);
      room.stack[count + below] = room.made[i];
    }
    count += n;
    ++round;
    __syncthreads();
  }
};

/// What a block of either kernel does: it searches for one configuration after another, whose parts share its bound, or
/// goes on with pieces that blocks have left. A block leaves very long work to the next launch, after all
/// configurations had their turn: the slowest of many takes twenty times as long as most. `search(configuration, number
/// of the piece)` begins with `best`.
template <class Arguments, class Search>
__device__ void search_in_turn(const Arguments& a, typename Arguments::memory_type& best, const Search& search) {
  for (std::uint32_t i = blockIdx.x, count = a.given.pieces != nullptr ? a.given.size() : a.configurations; i < count;
       i += gridDim.x) {
    const std::uint32_t c = a.given.pieces != nullptr ? a.given.pieces[i].configuration : i;
    if (!a.facts[c].rigid) continue;
    if (threadIdx.x == 0) best = a.all[c];
    __syncthreads();
    search(c, i);
    __syncthreads();
    if (threadIdx.x != 0) continue;
    if (a.given.pieces != nullptr)
      Arguments::question_type::add(a.all + c, best);
    else
      a.all[c] = best;
  }
}

/// One block per configuration searches by the trees of the parts.
template <class Arguments, class Tree>
__global__ void __launch_bounds__(256, 4)
    batch_kernel(const __grid_constant__ Arguments a, const __grid_constant__ Tree tree) {
  using memory_type = typename Arguments::memory_type;
  using block_type = block_search<tree_search<typename Arguments::body_type, Tree>>;
  extern __shared__ distance_key memory[];
  alignas(memory_type) __shared__ std::byte memory_of_best[sizeof(memory_type)];
  __shared__ typename block_type::words words;
  memory_type& best = *reinterpret_cast<memory_type*>(memory_of_best);
  search_in_turn(a, best, [&](std::uint32_t c, std::uint32_t piece) {
    const auto body = a.body(c, &best);
    const typename block_type::search_type search{{body, tree, a.bounds_of(c)}};
    block_type block{search, typename block_type::room_type(memory, blockDim.x, a.depth), words, a.depth};
    block.template begin<!Arguments::question_type::by_margin && !Tree::of_balls>(a, c, piece);
    if (!block.go_on(a.rounds) && !block.leave_to(a.left, c)) block.go_on(none);
  });
}

/// Shared memory of a block: a search's stack and what it makes in a round, the points that it has set aside and their
/// order, and each warp's nodes of an exact walk.
template <class PartView>
struct field_room {
  using walk_type = minimum::warp_walk<typename PartView::hierarchy_type>;
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

/// One block per configuration searches by the fields of the parts.
template <class Arguments, class Tree>
__global__ void __launch_bounds__(256, 4)
    field_kernel(const __grid_constant__ Arguments a, const __grid_constant__ Tree tree) {
  static_assert(Tree::fan <= 8 && Tree::tile <= 8, "one lane a child");
  using memory_type = typename Arguments::memory_type;
  using room_type = field_room<typename Arguments::part_type>;
  using block_type = block_search<field_search<typename Arguments::body_type, Tree>>;
  extern __shared__ distance_key memory[];
  alignas(memory_type) __shared__ std::byte memory_of_best[sizeof(memory_type)];
  __shared__ typename block_type::words words;
  memory_type& best = *reinterpret_cast<memory_type*>(memory_of_best);
  const room_type room(memory, blockDim.x);
  search_in_turn(a, best, [&](std::uint32_t c, std::uint32_t piece) {
    const auto body = a.body(c, &best);
    const typename block_type::search_type search{
        {body, tree, a.bounds_of(c)}, a.fields + a.first_part(c), searched_levels(tree, a.part_count, blockDim.x)};
    block_type block{search, room.stack, words, room_type::depth(blockDim.x), room.aside};
    block.template begin<!Arguments::question_type::by_margin>(a, c, piece);
    for (std::uint32_t rounds = a.rounds;;) {
      const bool done = block.go_on(rounds);
      if (block.aside != 0) {
        look_at(search, room, block.aside);
        block.taken();
      }
      if (done) break;
      if (block.round < rounds || block.next < search.starts()) continue;
      if (block.count == 0 || block.leave_to(a.left, c)) break;
      rounds = none;
    }
  });
}

}  // namespace clearance::plan
