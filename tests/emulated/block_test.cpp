// SPDX-License-Identifier: BSD-3-Clause
// The machine that runs kernels on a CPU finds what it is for.
#include "emulated/block.hpp"
#include "support/catch.hpp"

#include <cuda_runtime.h>

#include <vector>

namespace block_test {

namespace {

/// Runs a kernel by each of some schedules. Returns what the first that fails says.
template <class Body>
std::string first_fault(unsigned blocks, unsigned threads, const Body& body) {
  std::string said;
  for (unsigned seed = 0; seed < 9 && said.empty(); ++seed) {
    emulated::schedule(seed);
    said = emulated::run(blocks, threads, 0, body);
  }
  emulated::schedule(0);
  return said;
}
bool tells(const std::string& said, const std::string& words) {
  INFO(said);
  CHECK(said.find(words) != std::string::npos);
  return said.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("Threads meet, give values to one another, and count in order") {
  std::vector<unsigned> sums(8), ranks(8 * 96);
  const auto body = [&] {
    __shared__ unsigned all;
    if (threadIdx.x == 0) all = 0;
    __syncthreads();
    const unsigned lane = threadIdx.x % 32, before = __popc(__ballot_sync(~0u, lane % 3 == 0) & ((1u << lane) - 1));
    const unsigned next = __shfl_sync(~0u, lane, (int(lane) + 1) % 32), sum = __reduce_add_sync(~0u, lane);
    if (before == (lane + 2) / 3 && next == (lane + 1) % 32 && sum == 496) atomicAdd(&all, 1u);
    ranks[blockIdx.x * 96 + threadIdx.x] = unsigned(__syncthreads_count(threadIdx.x < 40));
    if (threadIdx.x >= 64) return;  // the others meet without them
    __syncthreads();
    if (threadIdx.x == 5) sums[blockIdx.x] = all;
  };
  CHECK(first_fault(8, 96, body) == "");
  CHECK(sums == std::vector<unsigned>(8, 96));
  CHECK(ranks == std::vector<unsigned>(8 * 96, 40));
}

TEST_CASE("Threads that wait for ever are told, and where they wait") {
  tells(first_fault(2, 64,
                    [] {
                      while (threadIdx.x != 3 || __ballot_sync(~0u, 1) == 0) __nanosleep(1);
                    }),
        "hangs: ");
  tells(first_fault(1, 64,
                    [] {
                      if (threadIdx.x % 32 < 16)
                        __syncwarp(0xffff);
                      else
                        __syncwarp();
                      __syncthreads();
                    }),
        "32 in __syncthreads, 32 in __syncwarp");
  static unsigned lock;
  lock = 0;
  tells(first_fault(1, 32,
                    [] {
                      while (atomicCAS(&lock, 0u, 1u) != 0) {
                      }
                      __syncwarp();  // the one that has the lock waits for those that want it
                      atomicExch(&lock, 0u);
                    }),
        "1 in __syncwarp");
}

TEST_CASE("Calls that must not meet are told") {
  tells(first_fault(1, 64,
                    [] {
                      if (threadIdx.x < 32)
                        __syncthreads();
                      else
                        __syncthreads_count(1);
                    }),
        "threads of a block meet in __syncthreads");
  tells(first_fault(1, 32, [] { threadIdx.x < 9 ? __any_sync(~0u, 1) : __all_sync(~0u, 1); }),
        "lanes of a warp meet in");
  tells(first_fault(1, 32, [] { __syncwarp(threadIdx.x == 4 ? 1u : ~(1u << 4)); }), "not in its mask");
  tells(first_fault(1, 32,
                    [] {
                      if (threadIdx.x < 8) __shfl_sync(0xff, 1u, 20);
                    }),
        "reads a lane that is not there");
  tells(first_fault(1, 32, [] { __trap(); }), "__trap");
}

TEST_CASE("Some schedule shows what has no barrier") {
  static thread_local unsigned word[32];
  std::vector<unsigned> found(32);
  const auto differs = [&](bool barrier) {
    for (unsigned seed = 0; seed < 9; ++seed) {
      emulated::schedule(seed);
      emulated::run(1, 32, 0, [&] {
        word[threadIdx.x] = 0;
        __syncwarp();
        word[threadIdx.x] = threadIdx.x + 1;
        if (barrier) __syncwarp();
        found[threadIdx.x] = word[(threadIdx.x + 1) % 32];
      });
      for (unsigned k = 0; k < 32; ++k)
        if (found[k] != (k + 1) % 32 + 1) return true;
    }
    return false;
  };
  CHECK(differs(false));
  CHECK_FALSE(differs(true));
}

}  // namespace block_test
