// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Warps of a block that have no packet left help the others: some packets take many times as long as most, and a block
// ends with its last one. Warps that share a packet keep their own finds and tell one another how near these are. The
// last to finish has all finds. No warp waits for another's walk. Who does what changes no answer: the least find
// counts, in any order.

#include <clearance/ground/ordered.hpp>
#include <clearance/result.hpp>
#include <clearance/scan/parts.cuh>

namespace clearance::scan {

/// What a warp works on.
struct packet_task {
  std::uint32_t packet;  ///< Its number.
  std::uint32_t shared;  ///< Its place in `sharing_memory`, if other warps work or have worked on it, too; or none.
  std::uint32_t nodes;   ///< If this warp helps: nodes in its stack. 0: the packet is its own.
  std::uint32_t part;    ///< Those nodes are of this part's tree,
  unsigned live;         ///< and for these points.
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
    for (auto& t : tasks) t.shared = none, t.nodes = 0;
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
      if (lane() == 0) given = fresh(task().shared) != none, over = fresh(memory().idle) == all_warps;
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
    const unsigned those = __ballot_sync(all_lanes, lane() < top && mine[lane()].bound <= most);
    if (__popc(those) < 2) return;
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
    const bool give = (those >> lane() & 1) != 0 && (__popc(those >> lane()) & 1) == 0;
    const unsigned given = __ballot_sync(all_lanes, give), live = __ballot_sync(all_lanes, reach > -infinity);
    if (give) {
      stacks[helper][__popc(given & ((1u << lane()) - 1))] = mine[lane()];
      mine[lane()].bound = not_a_number;  // not wanted here any more
    }
    if (first) s.packets[place].found[lane()] = v;
    packet_task& its = s.tasks[helper];
    if (lane() == 0) {
      task().shared = place;
      its.packet = task().packet, its.nodes = std::uint32_t(__popc(given)), its.part = k, its.live = live;
    }
    __threadfence_block();
    __syncwarp();
    if (lane() == 0) *static_cast<volatile std::uint32_t*>(&its.shared) = place;
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
      task().shared = none, task().nodes = 0;
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

}  // namespace clearance::scan
