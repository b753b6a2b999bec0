// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Warps of a block that have no packet left take points of another's, where each point is one warp's alone. Some
// packets take many times as long as most, and a block ends with its last one. Who does what changes no answer.

#include <clearance/scan/parts.cuh>

namespace clearance::scan {

/// Points of a packet that another warp has given away.
struct given_lanes {
  std::uint32_t packet;
  unsigned lanes;
};

/// In a block's shared memory. Warps meet here by atomics alone.
struct lane_memory {
  std::uint32_t idle;               ///< One bit per warp. If all are set, no warp has anything left to give.
  unsigned long long given[warps];  ///< A packet's number, then lanes of it; 0: nothing, as no lanes are given.

  __device__ void clear() {
    idle = 0;
    for (auto& g : given) g = 0;
  }
};

/// The whole warp calls each function here.
template <class Tally>
struct lane_sharing {
  /// Waits for work to help with. Returns false if no warp of the block has any left.
  static __device__ bool receive(given_lanes& work) {
    auto& s = memory();
    if (lane() == 0) atomicOr(&s.idle, 1u << warp());
    unsigned long long mine = 0;
    for (;;) {
      bool over = false;
      if (lane() == 0)
        mine = atomicExch(&s.given[warp()], 0ull), over = mine == 0 && atomicOr(&s.idle, 0u) == all_warps;
      mine = __shfl_sync(all_lanes, mine, 0);
      if (mine != 0) break;
      if (__any_sync(all_lanes, over)) return false;
      __nanosleep(1000);  // waiting warps should not slow working ones; how long changes no answer
    }
    work = {std::uint32_t(mine >> 32), unsigned(mine)};
    return true;
  }

  /// Does a warp of the block wait for work?
  static __device__ bool asked() { return __any_sync(all_lanes, lane() == 0 && atomicOr(&memory().idle, 0u) != 0); }

  /// Gives points to an idle warp. Returns false if there is none.
  static __device__ bool give(const given_lanes& work) {
    auto& s = memory();
    bool found = false;
    if (lane() == 0) {
      if (const unsigned idle = atomicOr(&s.idle, 0u); idle != 0 && idle != all_warps) {
        const std::uint32_t one = std::uint32_t(__ffs(int(idle))) - 1;
        found = (atomicAnd(&s.idle, ~(1u << one)) >> one & 1) != 0;
        if (found) atomicExch(&s.given[one], static_cast<unsigned long long>(work.packet) << 32 | work.lanes);
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
