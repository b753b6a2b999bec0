// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Warps of a block that have no packet left take points of another's, where each point is one warp's alone. Some
// packets take many times as long as most, and a block ends with its last one. Who does what changes no answer.

#include <clearance/scan/block.cuh>

namespace clearance::scan {

/// Points of a packet that another warp has given away.
struct given_lanes {
  std::uint32_t packet;
  unsigned lanes;  ///< 0: none.
};

/// In a block's shared memory. Warps write here by atomics alone.
struct lane_memory {
  std::uint32_t idle;  ///< One bit per warp. If all are set, no warp has anything left to give.
  given_lanes given[warps];

  __device__ void clear() {
    idle = 0;
    for (auto& g : given) g.lanes = 0;
  }
};

/// The whole warp calls each function here.
template <class Tally>
struct lane_sharing {
  /// Waits for work to help with. Returns false if no warp of the block has any left.
  static __device__ bool receive(given_lanes& work) {
    auto& mine = memory().given[warp()];
    if (lane() == 0) atomicOr(&memory().idle, 1u << warp());
    for (;;) {
      bool over = false, given = false;
      if (lane() == 0) {
        given = fresh(mine.lanes) != 0;
        over = fresh(memory().idle) == all_warps;
      }
      if (__any_sync(all_lanes, given)) break;
      if (__any_sync(all_lanes, over)) return false;
      __nanosleep(1000);  // waiting warps should not slow working ones; how long changes no answer
    }
    __threadfence_block();
    work = mine;
    __syncwarp();
    if (lane() == 0) atomicExch(&mine.lanes, 0u);
    return true;
  }

  /// Does a warp of the block wait for work?
  static __device__ bool asked() { return __any_sync(all_lanes, fresh(memory().idle) != 0); }

  /// Gives points to an idle warp. Returns false if there is none.
  static __device__ bool give(const given_lanes& work) {
    auto& s = memory();
    bool found = false;
    if (lane() == 0) {
      if (const unsigned idle = fresh(s.idle); idle != 0 && idle != all_warps) {
        const std::uint32_t one = std::uint32_t(__ffs(int(idle))) - 1;
        found = (atomicAnd(&s.idle, ~(1u << one)) >> one & 1) != 0;
        if (found) {
          atomicExch(&s.given[one].packet, work.packet);
          __threadfence_block();
          atomicExch(&s.given[one].lanes, work.lanes);
        }
      }
    }
    return __any_sync(all_lanes, found);
  }

 private:
  static constexpr unsigned all_warps = (1u << warps) - 1;
  static __device__ lane_memory& memory() { return memory_of_block<Tally>().sharing; }
  static __device__ std::uint32_t lane() { return threadIdx.x % 32; }
  static __device__ std::uint32_t warp() { return threadIdx.x / 32; }
};

}  // namespace clearance::scan
