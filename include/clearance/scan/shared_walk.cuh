// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Warps of a block that have no packet left help those that have: some packets take many times as long as most, and a
// block ends with its last. Whoever walks for a shared packet finds for itself, and tells how near; who is done last
// has all that was found. Nobody waits for another's walk, and who does what changes no answer: of what is found the
// least counts, in whatever order.

#include <clearance/ground/ordered.hpp>
#include <clearance/result.hpp>
#include <clearance/scan/parts.cuh>

namespace clearance::scan {

/// What a warp is at.
struct packet_task {
  std::uint32_t packet;  ///< Its number.
  std::uint32_t shared;  ///< Where in `sharing_memory` it is, if other warps are or have been at it, too; or none.
  std::uint32_t nodes;   ///< If this warp helps, so many are in its stack; 0: the packet is its own.
  std::uint32_t part;    ///< Those are of this part's tree,
  unsigned live;         ///< and for these points.
};

/// A packet that several warps walk for.
template <class Visitor>
struct shared_packet {
  std::uint32_t walkers;  ///< So many; 0: nobody, and the place is free.
  unsigned lock;          ///< Of `found`.
  Visitor found[32];
};

/// In a block's shared memory. For few packets at once, because what it takes is taken from the cache.
template <class Answer>
struct sharing_memory {
  static constexpr std::uint32_t most = 8;
  std::uint32_t idle;        ///< A bit a warp; if all are set, nobody can be handed anything any more.
  packet_task tasks[warps];  ///< In shared memory, because registers are few.
  shared_packet<typename Answer::visitor_type> packets[most];

  __device__ void clear() {
    idle = 0;
    for (auto& t : tasks) t.shared = none, t.nodes = 0;
    for (auto& p : packets) p.walkers = p.lock = 0;
  }
};

/// An answer's visitor says what another has found:
///   hear(other)  makes the reach no larger than that; is one's own nearer? `other` may be changing.
///   join(other)  takes it, if it is nearer.
template <class Answer>
struct shared_walk {
  using visitor = typename Answer::visitor_type;

  /// This warp's. The whole warp calls whatever is here.
  static __device__ packet_task& task() { return memory().tasks[warp()]; }
  static __device__ bool helps() { return task().nodes != 0; }

  /// Waits for something to help with, which is then this warp's task; false: no warp of the block has anything left.
  static __device__ bool receive() {
    __syncwarp();  // all have seen what this warp's last task was
    if (lane() == 0) atomicOr(&memory().idle, 1u << warp());
    for (;;) {
      bool over = false, given = false;
      if (lane() == 0) given = fresh(task().shared) != none, over = fresh(memory().idle) == all_warps;
      if (__any_sync(all_lanes, given)) break;
      if (__any_sync(all_lanes, over)) return false;
      __nanosleep(300);  // warps that wait should not take the working ones' turns; how long changes no answer
    }
    __threadfence_block();
    return true;
  }

  /// An own packet begins to be walked.
  static __device__ void begin(std::uint32_t packet) {
    if (lane() == 0) task().packet = packet;
  }

  /// Does a warp of the block wait for something to do? A few instructions.
  static __device__ bool asked() { return __any_sync(all_lanes, fresh(memory().idle) != 0); }

  /// Says and hears how near something is, if others are at this packet.
  static __device__ void talk(visitor& v) {
    const std::uint32_t place = task().shared;
    if (place == none) return;
    auto& p = memory().packets[place];
    if (!__any_sync(all_lanes, v.hear(p.found[lane()]))) return;
    acquire(p);
    p.found[lane()].join(v);
    release(p);
  }

  /// Hands every second of the nodes that this warp has still to look at in part k to an idle one, the nearest not;
  /// `stacks` are all warps'.
  template <class Node, std::size_t Room>
  static __device__ void hand_over(std::uint32_t k, real reach, const visitor& v, Node (&stacks)[warps][Room],
                                   std::uint32_t top) {
    auto& s = memory();
    Node* const mine = stacks[warp()];
    __syncwarp();  // all that has been pushed is there
    const real most = from_ordered(most_of(all_lanes, ordered(reach)));
    const unsigned those = __ballot_sync(all_lanes, lane() < top && mine[lane()].bound <= most);
    if (__popc(those) < 2) return;
    const bool first = task().shared == none;
    const std::uint32_t place = first ? warp() % sharing_memory<Answer>::most : task().shared;
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
      mine[lane()].bound = not_a_number;  // nobody wants it here
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

  /// The task is done. Was that all of its packet? Then `v` is all that was found.
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
  static __device__ sharing_memory<Answer>& memory() { return memory_of_block<Answer>().sharing; }
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
