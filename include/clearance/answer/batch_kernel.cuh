// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Many configurations down a tree over a cloud's points, on a device.

#include <clearance/answer/batch_arguments.hpp>
#include <clearance/scan/threads.cuh>

#include <type_traits>

namespace clearance::minimum {

/// What a block of so many threads keeps: pairs that are still to be opened, the nearest on top, and those that a round has made.
template <class Pair, class Order>
struct batch_room {
  static constexpr std::uint32_t lanes = 8;  ///< That open a pair together, a child each.

  Order* orders;  ///< Of what was made.
  Pair *stack, *made;

  /// Pairs are opened by ones before it is full, down to the last level.
  static constexpr std::uint32_t reserve = 128;
  CLEARANCE_HD static constexpr std::uint32_t least_depth(std::uint32_t threads) { return 512 + threads; }
  /// A pair of more children than lanes leaves, besides those, itself.
  CLEARANCE_HD static constexpr std::uint32_t most(std::uint32_t threads) { return threads + threads / lanes; }
  static constexpr std::size_t bytes(std::uint32_t threads, std::uint32_t depth) {
    return most(threads) * (sizeof(distance_key) + sizeof(Pair)) + depth * sizeof(Pair);
  }
  /// How deep a stack may be where a block has so many bytes.
  static constexpr std::uint32_t depth(std::uint32_t threads, std::size_t all) {
    const std::size_t others = bytes(threads, 0), least = least_depth(threads);
    return std::uint32_t(all < others + least * sizeof(Pair) ? least : (all - others) / sizeof(Pair));
  }
  __device__ batch_room(distance_key* memory, std::uint32_t threads, std::uint32_t depth)
      : orders(reinterpret_cast<Order*>(memory)), stack(reinterpret_cast<Pair*>(memory + most(threads))), made(stack + depth) {}
};

/// A block is a configuration, whose parts share its bound. In every round it opens the nearest pairs of its stack, each by eight lanes, and
/// puts what they made back in order: many at once, because what is found first decides how much the others are worth.
template <class Arguments, class Tree>
__global__ void __launch_bounds__(256, 4) batch_kernel(const __grid_constant__ Arguments a, const __grid_constant__ Tree tree) {
  using body_type = typename Arguments::body_type;
  using memory_type = typename Arguments::memory_type;
  using search_type = tree_search<body_type, Tree>;
  using pair = typename search_type::pair;
  using room_type = batch_room<pair, typename search_type::order_type>;
  constexpr std::uint32_t lanes = room_type::lanes;
  extern __shared__ distance_key memory[];
  __shared__ alignas(memory_type) std::byte memory_of_best[sizeof(memory_type)];
  __shared__ std::uint32_t made[2];  // of this round, and of the next
  memory_type& best = *reinterpret_cast<memory_type*>(memory_of_best);
  const std::uint32_t c = blockIdx.x, t = threadIdx.x, threads = blockDim.x;
  if (!a.facts[c].rigid) return;
  const room_type room(memory, threads, a.depth);
  if (t == 0) best = a.all[c], made[0] = made[1] = 0;
  __syncthreads();
  const body_type body = a.body(c, &best);
  const search_type search{body, tree, a.bounds + std::size_t(c) * a.part_count};
  if constexpr (!Arguments::question_type::by_margin)
    for (std::uint32_t i = t; i < 3 * a.part_count; i += threads)  // where it, and its neighbours, were nearest
      if (const std::uint32_t from = c + i / a.part_count - 1; from < a.configurations)
        if (const auto seed = a.seeds[from]; seed.number != none) search.visit(seed, i % a.part_count);
  __syncthreads();

  std::uint32_t count = 0, round = 0;
  const auto make = [&](const pair& p) {
    const std::uint32_t at = atomicAdd(&made[round % 2], 1u);
    room.made[at] = p, room.orders[at] = search.order(p);
  };
  /// Instead of the stack's last `taken` pairs what was made of them, the nearest on top.
  const auto put_back = [&](std::uint32_t taken) {
    __syncthreads();
    const std::uint32_t n = made[round % 2];
    if (t == 0) made[(round + 1) % 2] = 0;
    count -= taken;
    for (std::uint32_t i = t; i < n; i += threads) {
      const auto mine = room.orders[i];
      std::uint32_t below = 0;
      for (std::uint32_t j = 0; j < n; ++j) below += room.orders[j] > mine || (room.orders[j] == mine && j > i);
      room.stack[count + below] = room.made[i];
    }
    count += n, ++round;
    __syncthreads();
  };
  /// No room for what is below it: all its points at once.
  const auto visit_all = [&](const pair& p) {
    std::uint64_t begin = p.at, end = p.at + 1;
    for (std::uint32_t l = 0; l < p.level; ++l) begin *= l == 0 ? Tree::tile : Tree::fan, end *= l == 0 ? Tree::tile : Tree::fan;
    const cloud_tree::numbered_point* const points = tree.points;
    for (begin += t, end = end < tree.count ? end : tree.count; begin < end; begin += threads) search.visit(points[begin], p.part);
  };

  for (std::uint32_t next = 0, starts = search.starts(); next < starts || count > 0;) {
    if (count == 0) {
      pair p;
      if (next + t < starts && search.start(next + t, p)) make(p);
      next += threads;
      put_back(0);
      continue;
    }
    const std::uint32_t left = a.depth - count, many = left > room_type::reserve ? (left - room_type::reserve) / (lanes + 1) : 0;
    const std::uint32_t take = scan::lower_of(scan::lower_of(threads / lanes, count), many > 0 ? many : left > lanes);
    if (take == 0) {
      const pair top = room.stack[count - 1];
      visit_all(top);
      put_back(1);
      continue;
    }
    if (t / lanes < take) {
      const pair top = room.stack[count - 1 - t / lanes];
      const std::uint32_t j = top.from + t % lanes;
      if (!search.settled(top)) {
        const std::uint32_t size = search.children(top);
        pair p;
        if (j < size && search.child(top, j, p)) make(p);
        if (t % lanes == 0 && top.from + lanes < size) p = top, p.from += lanes, make(p);
      }
    }
    put_back(take);
  }
  if (t == 0) a.all[c] = best;
}

}  // namespace clearance::minimum
