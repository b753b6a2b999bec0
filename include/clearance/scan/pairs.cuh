// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Tests the few points near a part against the trees. Every warp walks with some of them: eight nodes at once, four
// lanes per node, from its own stack. What is too much for it is dealt to all warps at the end.

#include <clearance/ground/ordered.hpp>
#include <clearance/result.hpp>
#include <clearance/robot/cells.hpp>
#include <clearance/robot/field.hpp>
#include <clearance/scan/cell_pairs.cuh>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/reader.cuh>
#include <clearance/scan/steps.cuh>

namespace clearance::scan {

// Takes many pairs of a point and a part down to one leaf each, a thread per pair. That leaf is nearly always enough.
// A part's field, if there is one, decides most pairs before.

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
    const field_range range = fields[part](frame::place(part).part_from_cloud(c.x));
    const bool outside = !has_interior<typename Tally::part_type> || range.side == field_side::outside;
    passed = outside ? range.low : -infinity;
    Tally::hear_bound(s, part, i, range.high);
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

template <class Tally>
struct pair_search : cell_pairs<Tally> {
  using frame = frame_parts<Tally>;
  using steps = tree_steps<Tally>;
  using hierarchy = typename Tally::part_type::hierarchy_type;
  using memory = typename Tally::block;
  using pending = typename memory::pending_type;
  using node_type = typename steps::node_type;
  using typename pair_elements<Tally>::element;
  using cell_pairs<Tally>::mates, cell_pairs<Tally>::lane, cell_pairs<Tally>::group, cell_pairs<Tally>::inside;
  using pair = pair_of<element>;
  static constexpr bool any_size = node_of<hierarchy>::any_size;

  /// Keeps pairs for `drain`: `near` has a bit for each of a lane's points that is near a part of the cluster from
  /// `first_part` on, four bits per part. Returns those that it has no room for. The pairs that come first always have
  /// room.
  static __device__ unsigned add(unsigned near, const quad_points& p, std::uint32_t first, std::uint32_t first_part) {
    static_assert(quad * cluster <= 32 && pair_capacity >= quad * cluster);
    memory& s = frame::here();
    std::uint32_t slot = atomicAdd(&s.pairs, std::uint32_t(__popc(near)));
    unsigned left = 0;
#pragma unroll
    for (int j = 0; j < quad; ++j) {
      unsigned near_parts = near >> j & 0x11111111u;
      for (; near_parts != 0 && slot < pair_capacity; near_parts &= near_parts - 1, ++slot) {
        s.pair_table[slot] = {pair_search::element_at(first + j, p.at[j]), s.head.first + first + j};
        s.part_of_pair[slot] = std::uint16_t(first_part + (unsigned(__ffs(int(near_parts))) - 1) / quad);
      }
      left |= near_parts << j;
    }
    return left;
  }

  /// Searches all kept pairs to the end. `found` is at least their number. The whole block calls it together.
  static __device__ void drain(std::uint32_t found) {
    memory& s = frame::here();
    if (found == 0) return;
    const std::uint32_t count = found < pair_capacity ? found : pair_capacity;
    if constexpr (Tally::goes_ahead) {
      leaf_first<Tally>::go(count);
      walk(Tally::open_pairs(s));
    } else {
      walk(count);
    }
    __syncthreads();
    Tally::drained(s, count);
    if (threadIdx.x == 0) s.pairs = s.given = 0;  // a barrier comes before the next pair is kept
  }

 private:
  static constexpr std::uint32_t at_once = 32 / mates;  ///< Nodes that a warp tests together.

  /// Transforms a pair's point into its part's frame. Pushes the root's children within reach, or the root if it is a
  /// leaf, unless the pair ends here. Four lanes per pair.
  static __device__ std::uint32_t admit(std::uint32_t i, bool live, pending* stack, std::uint32_t top) {
    memory& s = frame::here();
    const pair c = live ? s.pair_table[i] : pair{};
    const std::uint32_t part = live ? s.part_of_pair[i] : 0;
    live = live && pair_search::near_part(s, part, c.x) && !Tally::skips(s, part, c.point, i, start_of(c.x));
    if constexpr (Tally::goes_ahead) {  // other warps may be changing the inputs of `live`, and this one is about to
      live = (__ballot_sync(all_lanes, live) >> group() * mates & 1) != 0;
      __syncwarp();
    }
    const element q = moved(frame::place(part).part_from_cloud, c.x);
    if constexpr (has_interior<typename Tally::part_type>) {
      const unsigned gone =
          __ballot_sync(all_lanes, live && lane() == 0 && inside(q, c.point, part, i)) >> group() * mates;
      live = live && (gone & 1) == 0;
    }
    __syncwarp();  // all lanes have read the pair
    if (live && lane() == 0) s.pair_table[i].x = q;
    if constexpr (pair_search::by_cells) live = pair_search::look_up(live, i, part, q);
    node_type root{};
    if (live) root = steps::root(part);
    const bool leaf = live && steps::is_leaf(part, root);
    const std::uint32_t pair_and_part = part << 16 | i;
    const real reach = Tally::reach_of_pair(s, part, i);
    top = push({-infinity, root, pair_and_part}, leaf && lane() == 0, stack, top);
    const std::uint32_t size = live && !leaf ? steps::size(part, root) : 0;
    return push_children(-infinity, root, size, pair_and_part, q, reach, stack, top);
  }

  /// A warp's share of the pairs, then of what warps have given away: a far point can be about equally far from
  /// hundreds of nodes. It takes nodes from the end of its stack, fewer as the stack fills, and at last one, whose
  /// subtree fits into the reserve. So the stack cannot overflow. For larger trees it takes one node at a time, and the
  /// lower end of the stack goes to memory.
  static __device__ void walk(std::uint32_t count) {
    memory& s = frame::here();
    const std::uint32_t warp = threadIdx.x / 32;
    pending* const stack = s.stack[warp];
    typename Tally::news elsewhere(s);
    std::uint32_t top = 0, row = 0;
    [[maybe_unused]] std::uint32_t below = 0;  // nodes in memory
    bool shared = false;

#pragma unroll 1
    for (int round = 0;; ++round) {
#pragma unroll 1
      for (; row * warps < count && top < at_once && (!any_size || below == 0); row += at_once) {
        // A point's pairs follow one another, and so do its neighbours'. So each row begins with another warp.
        const std::uint32_t turn = row + group(), i = turn * warps + (turn + warp) % warps;
        if constexpr (Tally::goes_ahead)
          top = admit(i < count ? Tally::open_pair(s, i) : 0, i < count, stack, top);
        else
          top = admit(i, i < count, stack, top);
      }

      if constexpr (any_size)
        if (top == 0 && below != 0) {
          top = below < at_once ? below : at_once;
          below -= top;
          raise(stack, top, below);
        }

      if (top == 0) {
        if (shared) break;
        __syncthreads();
        shared = true;
        top = take_share(stack);
        continue;
      }

      if (round % 8 == 7) elsewhere.hear(s);
      constexpr std::uint32_t room = stack_capacity - deepest_stack, growth = most_children - 1;
      static_assert(at_once - 1 + at_once * most_children <= room - at_once * growth &&
                    at_once - 1 + at_once * (most_children + 1) < stack_capacity);
      std::uint32_t taken = top < at_once ? top : at_once;
      if (top > room - at_once * growth) taken = top + 2 * growth <= room ? 2 : 1;
      __syncwarp();  // all pushes are visible
      if constexpr (any_size)
        if (s.head.overflow != nullptr) {
          taken = 1;
          if (top > room) {
            sink(stack, top, below);
            below += top - at_once;
            top = at_once;
          }
        }

      const pending e = group() < taken ? stack[top - 1 - group()] : pending{not_a_number, {}, 0};  // within no reach
      __syncwarp();
      top = expand(e, stack, top - taken);
      if (!shared && top > 2 * at_once) top = give(stack, top);
    }
  }

  /// The first child of a node that has not been tested yet.
  static __device__ std::uint32_t first_of(std::uint32_t pair) {
    if constexpr (any_size) return steps::begin(pair);
    return 0;
  }
  static __device__ std::uint32_t of_child(std::uint32_t pair) {
    if constexpr (any_size) return steps::from_first(pair);
    return pair;
  }

  /// This warp's memory for the lower end of its stack.
  static __device__ pending* memory_below() {
    const auto& head = frame::here().head;
    return reinterpret_cast<pending*>(head.overflow) +
           std::size_t(blockIdx.x * warps + threadIdx.x / 32) * head.overflow_room;
  }
  /// Moves all nodes but the last eight there. All lanes of a warp call it.
  static __noinline__ __device__ void sink(pending* stack, std::uint32_t top, std::uint32_t below) {
    const std::uint32_t lane = threadIdx.x % 32, some = top - at_once;
    if (below + some > frame::here().head.overflow_room) __trap();  // the tree is deeper than it claimed
    for (std::uint32_t k = lane; k < some; k += 32) memory_below()[below + k] = stack[k];
    pending kept;
    if (lane < at_once) kept = stack[some + lane];
    __syncwarp();
    if (lane < at_once) stack[lane] = kept;
    __syncwarp();
  }
  /// Moves `some` of them back to the stack.
  static __noinline__ __device__ void raise(pending* stack, std::uint32_t some, std::uint32_t below) {
    const std::uint32_t lane = threadIdx.x % 32;
    __syncwarp();
    if (lane < some) stack[lane] = memory_below()[below + lane];
    __syncwarp();
  }

  /// Gives away all but the first eight of a warp's nodes, if there is room for all. Returns the stack's new size. If
  /// another warp is quicker, some nodes are both kept and given, and tested twice. All lanes of a warp call it.
  static __device__ std::uint32_t give(const pending* stack, std::uint32_t top) {
    memory& s = frame::here();
    const std::uint32_t lane = threadIdx.x % 32, some = top - at_once;
    std::uint32_t at = memory::given_capacity;
    if (lane == 0 && fresh(s.given) + some <= memory::given_capacity) at = atomicAdd(&s.given, some);
    at = __shfl_sync(all_lanes, at, 0);
    __syncwarp();  // all pushes are visible
#pragma unroll 1
    for (std::uint32_t k = lane; k < some && at + k < memory::given_capacity; k += 32)
      s.given_nodes[at + k] = stack[at_once + k];
    return at + some <= memory::given_capacity ? at_once : top;
  }

  /// Takes this warp's share of what all have given. Returns the stack's size.
  static __device__ std::uint32_t take_share(pending* stack) {
    memory& s = frame::here();
    const std::uint32_t lane = threadIdx.x % 32, warp = threadIdx.x / 32, i = lane * warps + warp;
    const std::uint32_t given = s.given < memory::given_capacity ? s.given : memory::given_capacity;
    if (i < given) stack[lane] = s.given_nodes[i];
    return (given + warps - 1 - warp) / warps;
  }

  /// Pushes inner children within reach and tests primitives. All lanes of a warp call it.
  static __device__ std::uint32_t expand(const pending& e, pending* stack, std::uint32_t top) {
    memory& s = frame::here();
    const std::uint32_t part = steps::part_of(e.pair), i = steps::pair_of(e.pair);
    pair v{};
    if (e.bound == e.bound) v = s.pair_table[i];  // otherwise another warp may be writing there
    const real reach = Tally::reach_of_pair(s, part, i);
    const bool live = e.bound <= reach, leaf = live && steps::is_leaf(part, e.node);
    const std::uint32_t count = live ? steps::size(part, e.node) : 0;
    std::uint32_t left = leaf ? 0 : count;  // children that are not yet pushed
    if constexpr (any_size)
      if (left != 0) left -= first_of(e.pair);
    top = push_children(e.bound, e.node, left, e.pair, v.x, reach, stack, top);
    examine(e.node, leaf ? count : 0, part, i, v, reach);
    return top;
  }

  /// Pushes the first of `count` children if within reach, and the node for the rest. Returns the stack's new size.
  static __device__ std::uint32_t push_children(real bound, const node_type& node, std::uint32_t count,
                                                std::uint32_t pair_and_part, const element& q, real reach,
                                                pending* stack, std::uint32_t top) {
    constexpr std::uint32_t each = most_children / mates;
    if constexpr (any_size) {
      if (count > most_children &&
          (frame::here().head.overflow == nullptr || first_of(pair_and_part) + count > most_width))
        __trap();  // the tree is wider than it claimed
      pending others{bound, node, pair_and_part};
      steps::skip(others.pair);
      top = push(others, count > most_children && lane() == 0, stack, top);
    }
    pending child[each];
    bool within[each];
#pragma unroll
    for (std::uint32_t j = 0; j < each; ++j) {
      child[j] = {infinity, {}, of_child(pair_and_part)};
      const std::uint32_t k = lane() + j * mates;
      if (k < count) {
        const auto step = steps::child(steps::part_of(pair_and_part), node, first_of(pair_and_part) + k);
        child[j] = {bound_of(step.volume, q, reach), step.node, of_child(pair_and_part)};
      }
      within[j] = k < count && child[j].bound <= reach;
    }
#pragma unroll
    for (std::uint32_t j = 0; j < each; ++j) top = push(child[j], within[j], stack, top);
    return top;
  }

  /// All lanes with `mine` push at once. Returns the stack's new size.
  static __device__ std::uint32_t push(const pending& e, bool mine, pending* stack, std::uint32_t top) {
    const unsigned pushing = __ballot_sync(all_lanes, mine);
    pending* const place = stack + top + __popc(pushing & ((1u << threadIdx.x % 32) - 1));
    if (mine) *place = e;
    return top + std::uint32_t(__popc(pushing));
  }

  /// Tests the primitives of leaves. All lanes of a warp call it.
  static __device__ void examine(const node_type& leaf, std::uint32_t count, std::uint32_t part, std::uint32_t pair,
                                 const pair_search::pair& v, real reach) {
#pragma unroll 1
    for (std::uint32_t k = lane(); __any_sync(all_lanes, k < count); k += mates) {
      typename Tally::record r;
      typename hierarchy::primitive_type primitive;
      if (k < count) {
        const auto place = steps::place_of(leaf, k);
        const std::uint32_t id = steps::id(part, place);
        primitive = steps::primitive(part, place);
        if (const real distance = distance_of(primitive, v.x, reach); distance <= reach)
          r = {make_key(distance, v.point), part, id, place};
      }
      if (__any_sync(all_lanes, r.key != no_key)) Tally::take(frame::here(), r, primitive, pair);
    }
  }
};

}  // namespace clearance::scan
