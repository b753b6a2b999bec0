// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Neighbouring points walk the trees as packets: a warp walks once for 32 points, one per lane, and all lanes test the
// same node. A node is taken if any lane wants it, the nearest first. At a jump in depth the points before and behind
// it go one group after the other: if each lane walked alone, they would end last. Points that are not neighbours do
// walk alone. (A first test of children with a ball around the packet is slower: farther away it passes too many.)

#include <clearance/ground/ordered.hpp>
#include <clearance/result.hpp>
#include <clearance/scan/block.cuh>
#include <clearance/scan/lane_sharing.cuh>
#include <clearance/scan/lone_search.cuh>

namespace clearance::scan {

// Warps of a block that have no packet left help the others: some packets take many times as long as most, and a block
// ends with its last one. Warps that share a packet keep their own finds and tell one another how near these are. The
// last to finish has all finds. No warp waits for another's walk. Who does what changes no answer: the least find
// counts, in any order.

/// What a warp works on.
struct packet_task {
  std::uint32_t packet;  ///< The packet's number.
  std::uint32_t shared;  ///< The packet's place in `sharing_memory`, if other warps have worked on it, too; or none.
  std::uint32_t nodes;   ///< If this warp helps: nodes in its stack. 0: the packet is its own.
  std::uint32_t part;    ///< If this warp helps: whose tree the nodes are of.
  unsigned live;         ///< If this warp helps: the points that the nodes are for, one bit each.
};

/// A packet that several warps work on.
template <class Visitor>
struct shared_packet {
  std::uint32_t walkers;  ///< How many warps; 0: none, and the place is free.
  unsigned lock;          ///< Guards `found`.
  Visitor found[32];
};

/// In a block's shared memory. It holds few packets at once, because it takes its room from the cache.
template <class Tally>
struct sharing_memory {
  static constexpr std::uint32_t most = 8;
  std::uint32_t idle;        ///< One bit per warp. If all are set, no warp has anything left to hand over.
  packet_task tasks[warps];  ///< In shared memory, because registers are few.
  shared_packet<typename Tally::visitor_type> packets[most];

  __device__ void clear() {
    idle = 0;
    for (auto& t : tasks) {
      t.shared = none;
      t.nodes = 0;
    }
    for (auto& p : packets) p.walkers = p.lock = 0;
  }
};

/// An answer's visitor takes what another one has found:
///   hear(other)  lowers the reach to the other's; returns true if its own find is nearer. `other` may be changing.
///   join(other)  takes the other's find if it is nearer.
template <class Tally>
struct shared_walk {
  using visitor = typename Tally::visitor_type;

  /// This warp's task. The whole warp calls each function here.
  static __device__ packet_task& task() { return memory().tasks[warp()]; }
  static __device__ bool helps() { return task().nodes != 0; }

  /// Waits for work to help with, which is then this warp's task. Returns false if no warp of the block has any left.
  static __device__ bool receive() {
    __syncwarp();  // all lanes have read this warp's last task
    if (lane() == 0) atomicOr(&memory().idle, 1u << warp());
    for (;;) {
      bool over = false, given = false;
      if (lane() == 0) {
        given = fresh(task().shared) != none;
        over = fresh(memory().idle) == all_warps;
      }
      if (__any_sync(all_lanes, given)) break;
      if (__any_sync(all_lanes, over)) return false;
      __nanosleep(300);  // waiting warps should not slow working ones; how long changes no answer
    }
    __threadfence_block();
    return true;
  }

  /// Begins a packet of this warp's own.
  static __device__ void begin(std::uint32_t packet) {
    if (lane() == 0) task().packet = packet;
  }

  /// Does a warp of the block wait for work? It takes a few instructions.
  static __device__ bool asked() { return __any_sync(all_lanes, fresh(memory().idle) != 0); }

  /// Exchanges how near something is with other warps on this packet.
  static __device__ void talk(visitor& v) {
    const std::uint32_t place = task().shared;
    if (place == none) return;
    auto& p = memory().packets[place];
    if (!__any_sync(all_lanes, v.hear(p.found[lane()]))) return;
    acquire(p);
    p.found[lane()].join(v);
    release(p);
  }

  /// Hands every second of this warp's pending nodes in part k to an idle warp, but never the nearest. `stacks` are
  /// those of all warps.
  template <class Node, std::size_t Room>
  static __device__ void hand_over(std::uint32_t k, real reach, const visitor& v, Node (&stacks)[warps][Room],
                                   std::uint32_t top) {
    auto& s = memory();
    Node* const mine = stacks[warp()];
    __syncwarp();  // all pushes are visible
    const real most = from_ordered(most_of(all_lanes, ordered(reach)));
    const unsigned wanted = __ballot_sync(all_lanes, lane() < top && mine[lane()].bound <= most);
    if (__popc(wanted) < 2) return;

    const bool first = task().shared == none;
    const std::uint32_t place = first ? warp() % sharing_memory<Tally>::most : task().shared;
    std::uint32_t helper = none;
    if (lane() == 0 && (!first || atomicCAS(&s.packets[place].walkers, 0u, 1u) == 0)) {
      if (const unsigned idle = fresh(s.idle); idle != 0) {
        const std::uint32_t one = std::uint32_t(__ffs(int(idle))) - 1;
        if ((atomicAnd(&s.idle, ~(1u << one)) >> one & 1) != 0) helper = one;
      }
      if (helper != none)
        atomicAdd(&s.packets[place].walkers, 1u);
      else if (first)
        atomicExch(&s.packets[place].walkers, 0u);
    }
    helper = __shfl_sync(all_lanes, helper, 0);
    if (helper == none) return;

    const bool give = (wanted >> lane() & 1) != 0 && (__popc(wanted >> lane()) & 1) == 0;
    const unsigned given = __ballot_sync(all_lanes, give), live = __ballot_sync(all_lanes, reach > -infinity);
    if (give) {
      stacks[helper][__popc(given & ((1u << lane()) - 1))] = mine[lane()];
      mine[lane()].bound = not_a_number;  // not wanted here any more
    }
    if (first) s.packets[place].found[lane()] = v;

    packet_task& handed = s.tasks[helper];
    if (lane() == 0) {
      task().shared = place;
      handed.packet = task().packet;
      handed.nodes = std::uint32_t(__popc(given));
      handed.part = k;
      handed.live = live;
    }
    __threadfence_block();
    __syncwarp();
    if (lane() == 0) *static_cast<volatile std::uint32_t*>(&handed.shared) = place;
  }

  /// Ends the task. Returns true if its packet is done; then `v` is all that was found.
  static __device__ bool last(visitor& v) {
    const std::uint32_t place = task().shared;
    if (place == none) return true;
    auto& p = memory().packets[place];
    acquire(p);
    p.found[lane()].join(v);
    v = p.found[lane()];
    __syncwarp();
    std::uint32_t others = 0;
    if (lane() == 0) {
      others = atomicSub(&p.walkers, 1u) - 1;
      task().shared = none;
      task().nodes = 0;
    }
    release(p);
    return __shfl_sync(all_lanes, others, 0) == 0;
  }

 private:
  static constexpr unsigned all_warps = (1u << warps) - 1;
  static __device__ sharing_memory<Tally>& memory() { return memory_of_block<Tally>().sharing; }
  static __device__ std::uint32_t lane() { return threadIdx.x % 32; }
  static __device__ std::uint32_t warp() { return threadIdx.x / 32; }

  static __device__ void acquire(shared_packet<visitor>& p) {
    if (lane() == 0)
      while (atomicCAS(&p.lock, 0u, 1u) != 0) __nanosleep(20);
    __threadfence_block();
    __syncwarp();
  }
  static __device__ void release(shared_packet<visitor>& p) {
    __threadfence_block();
    __syncwarp();
    if (lane() == 0) atomicExch(&p.lock, 0u);
  }
};

/// A node that is no nearer than `bound` to any point of a packet.
template <class Node>
struct packet_node {
  real bound;
  Node node;
};

template <class Tally>
struct shared_packet_memory : block_memory<Tally> {
  using node_type = packet_node<typename node_of<typename block_memory<Tally>::hierarchy_type>::type>;
  alignas(16) node_type stack[warps][deepest_stack];
  sharing_memory<Tally> sharing;

  __device__ void clear() { sharing.clear(); }
};
template <class Tally>
struct packet_search : lone_search<Tally> {
  using frame = frame_parts<Tally>;
  using steps = tree_steps<Tally>;
  using hierarchy = typename Tally::part_type::hierarchy_type;
  using traits = bounding_volume_traits<typename hierarchy::volume_type>;
  using node_type = typename steps::node_type;
  using stacked = packet_node<node_type>;
  using sharing = shared_walk<Tally>;
  static constexpr bool begins_anew = false;  ///< A warp that helps begins with nothing found.
  using lone_search<Tally>::lane, lone_search<Tally>::inside, lone_search<Tally>::gap_to, lone_search<Tally>::alone;

  /// Waits for a part of another warp's packet, and for which of its lanes. Returns false if there is none left.
  static __device__ bool receive(given_lanes& work) {
    if (!sharing::receive()) return false;
    work = {sharing::task().packet, sharing::task().live};
    return true;
  }

  /// Searches for this lane's point `x`, in the cloud's frame, if it is `live`. The whole warp calls it. Returns the
  /// lanes that now have their answers; other warps may still work on the rest.
  template <class Visitor>
  static __device__ unsigned search(std::uint32_t packet, std::uint32_t, unsigned, bool live, vec3 x, Visitor& v) {
    groups(packet, live, x, v);
    return sharing::last(v) ? all_lanes : 0;
  }

 private:
  template <class Visitor>
  static __device__ void groups(std::uint32_t packet, bool live, vec3 x, Visitor& v) {
    unsigned left = __ballot_sync(all_lanes, live);
    if (left == 0) return;
    const bool helps = sharing::helps();
    if (!helps) sharing::begin(packet);
#pragma unroll 1
    while (left != 0) {
      const unsigned later = left >> 16 << 16;  // the middle one of neighbours in a row, if it is left
      const vec3 middle = from_lane(x, later != 0 ? __ffs(int(later)) - 1 : 31 - __clz(int(left)));
      const real way = rough_length(x - middle);
      unsigned near = left;
      if (!helps && !too_deep()) {
        const real most = gap_to(middle) / 2;
        near = __ballot_sync(all_lanes, live && way <= most);
        if (4 * __popc(near) < __popc(left)) {  // not neighbours
          v = alone(live, x, v);
          return;
        }
      }
      const bool is_near = (near >> lane() & 1) != 0;
      together(live && is_near, x, middle, from_bits(most_of(all_lanes, is_near ? to_bits(way) : 0)) * (1 + slack), v);
      live = live && !is_near;
      left &= ~near;
    }
  }

  static constexpr std::uint32_t at_once = most_children;
  static constexpr std::uint32_t worth_sharing = 4;  ///< Fewer pending nodes are tested faster than handed over.
  /// Searches part by part for points within `spread` of their middle.
  template <class Visitor>
  static __device__ void together(bool live, vec3 x, vec3 middle, real spread, Visitor& v) {
    const bool helps = sharing::helps();
    const std::uint32_t first = helps ? sharing::task().part : 0, end = helps ? first + 1 : frame::here().head.parts;
#pragma unroll 1
    for (std::uint32_t begin = first; begin < end; begin += 32) {  // one part per lane, the nearest first
      std::uint32_t mine = no_bound;
      if (begin + lane() < end) {
        const ball around = frame::place(begin + lane()).root.around;
        const real d = rough_length(middle - around.center);
        mine = ordered(lowered(d - around.radius - spread, d + around.radius + spread));
      }
#pragma unroll 1
      for (;;) {
        const std::uint32_t nearest = least_of(all_lanes, mine);
        if (nearest == no_bound) break;
        const std::uint32_t holder = std::uint32_t(__ffs(int(__ballot_sync(all_lanes, mine == nearest)))) - 1,
                            k = begin + holder;
        if (lane() == holder) mine = no_bound;
        if (__any_sync(all_lanes, live && from_ordered(nearest) <= v.reach(k))) ask(k, live, x, v);
      }
    }
  }

  /// Trees may be too deep or wide for stacks in shared memory.
  static __device__ bool too_deep() {
    if constexpr (node_of<hierarchy>::any_size) return frame::here().head.overflow != nullptr;
    return false;
  }
  static __device__ stacked* own_stack() {
    auto& s = frame::here();
    if (too_deep())
      return reinterpret_cast<stacked*>(s.head.overflow) +
             std::size_t(blockIdx.x * warps + threadIdx.x / 32) * s.head.overflow_room;
    return s.stack[threadIdx.x / 32];
  }

  template <class Visitor>
  static __device__ void ask(std::uint32_t k, bool live, vec3 x, Visitor& v) {
    const frame_part& place = frame::place(k);
    const vec3 q = place.part_from_cloud(x);
    live = live && frames::may_reach(place.root.around, v.reach(k), x);
    if (live && !sharing::helps() && inside(k, x, v)) live = false;
    walk(k, live, q, v);
  }

  /// Walks part k's tree with all lanes together.
  template <class Visitor>
  static __device__ void walk(std::uint32_t k, bool live, vec3 q, Visitor& v) {
    sharing::talk(v);
    real reach = live ? v.reach(k) : -infinity;
    stacked* const stack = own_stack();
    const std::uint32_t given = sharing::task().nodes;
    std::uint32_t top = given != 0 ? given : 1;
    __syncwarp();
    if (lane() == 0 && given == 0) stack[0] = {-infinity, steps::root(k)};

#pragma unroll 1
    while (top > 0) {
      __syncwarp();  // all pushes are visible
      const stacked e = stack[--top];
      if (!__any_sync(all_lanes, e.bound <= reach)) continue;
      const std::uint32_t count = steps::size(k, e.node);
      if (steps::is_leaf(k, e.node)) {
#pragma unroll 1
        for (std::uint32_t j = 0; j < count; ++j) {
          const auto place = steps::place_of(e.node, j);
          const auto primitive = steps::primitive(k, place);
          if constexpr (bounded_primitive<typename hierarchy::primitive_type>)  // a rough test is enough for most
            if (__all_sync(all_lanes, primitive.lower_bound(q) > reach)) continue;
          if (const real d = primitive.distance(q); d <= reach) {
            v.offer(k, place, steps::id(k, place), d);
            reach = v.reach(k);
          }
        }
        continue;
      }

#pragma unroll 1
      for (std::uint32_t begin = 0; begin < count; begin += at_once)
        top = push(k, e.node, begin, count, q, reach, stack, top);
      if (top > worth_sharing && sharing::asked() && !too_deep()) {
        sharing::talk(v);
        reach = min(reach, v.reach(k));
        sharing::hand_over(k, reach, v, frame::here().stack, top);
      }
    }
  }

  /// Pushes those of eight children that some point wants, the nearest on top. Returns the stack's new size.
  static __device__ std::uint32_t push(std::uint32_t k, const node_type& node, std::uint32_t begin, std::uint32_t count,
                                       vec3 q, real reach, stacked* stack, std::uint32_t top) {
    constexpr std::uint32_t unwanted = none,
                            number =
                                at_once - 1;  // the lowest bits of a bound hold the child's number, so no two are equal
    std::uint32_t low[at_once];
#pragma unroll
    for (std::uint32_t four = 0; four < at_once; four += 4) {
      if (begin + four >= count) {
#pragma unroll
        for (std::uint32_t h = four; h < four + 4; ++h) low[h] = unwanted;
        continue;
      }
#pragma unroll
      for (std::uint32_t h = four; h < four + 4; ++h) {
        const std::uint32_t j = lower_of(begin + h, count - 1);  // without a branch, so that all four are read at once
        const real b = traits::lower_bound(steps::child(k, node, j).volume, q);
        low[h] = least_of(all_lanes, begin + h < count && b <= reach ? (ordered(b) & ~number) | h : unwanted);
      }
    }

    std::uint32_t mine = unwanted, nearer = 0, all = 0;  // one child per lane
#pragma unroll
    for (std::uint32_t h = 0; h < at_once; ++h) mine = lane() == h ? low[h] : mine;
#pragma unroll
    for (std::uint32_t h = 0; h < at_once; ++h) {
      all += low[h] != unwanted;
      nearer += low[h] < mine;
    }

    __syncwarp();  // all have read the node
    if (mine != unwanted)
      stack[top + all - 1 - nearer] = {from_ordered(mine & ~number), steps::child(k, node, begin + lane()).node};
    return top + all;
  }
};

}  // namespace clearance::scan
