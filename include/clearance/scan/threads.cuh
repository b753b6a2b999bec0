// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How the threads of a block are divided, and what a warp agrees on.

#include <clearance/ground/math.hpp>
#include <clearance/ground/ptx.hpp>
#include <clearance/ground/read_only.hpp>

namespace clearance::scan {

inline constexpr int block_threads = 512;
inline constexpr std::uint32_t warps = block_threads / 32;
inline constexpr std::uint32_t all_lanes = 0xffffffffu;

template <class T>
__device__ T fresh(const T& shared) {
  return *static_cast<const volatile T*>(&shared);
}

/// Adds one to a counter of the whole device and returns its old value. Threads that count later see what this thread
/// wrote before. This thread sees what others wrote before they counted. It is what cuda::atomic_ref's fetch_add
/// becomes; <cuda/atomic> takes a compiler two seconds to read.
__device__ inline std::uint32_t count_in(std::uint32_t& counter) { return ptx::add_one_in_order(counter); }

__device__ inline std::uint32_t lower_of(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }

/// The least of the values of the lanes in `mask`, which all call it together.
__device__ inline std::uint32_t least_of(unsigned mask, std::uint32_t value) {
#if __CUDA_ARCH__ >= 800
  return __reduce_min_sync(mask, value);
#else
  std::uint32_t least = value;
  for (unsigned left = mask; left != 0; left &= left - 1) {
    const std::uint32_t other = __shfl_sync(mask, value, __ffs(int(left)) - 1);
    least = other < least ? other : least;
  }
  return least;
#endif
}

/// The largest of them.
__device__ inline std::uint32_t most_of(unsigned mask, std::uint32_t value) { return ~least_of(mask, ~value); }

/// Gives the value of one lane of a warp to all that call it.
template <class T>
__device__ T from_lane(const T& mine, int lane, unsigned mask = all_lanes) {
  static_assert(sizeof(T) % sizeof(std::uint32_t) == 0);
  as_words<T, std::uint32_t> of;
  of.value = mine;
#pragma unroll
  for (std::size_t i = 0; i < sizeof(T) / sizeof(std::uint32_t); ++i)
    of.words[i] = __shfl_sync(mask, of.words[i], lane);
  return of.value;
}

/// The sum of a warp's lanes.
__device__ inline std::uint32_t sum_of(std::uint32_t value) {
#if __CUDA_ARCH__ >= 800
  return __reduce_add_sync(all_lanes, value);
#else
  for (int width = 16; width > 0; width /= 2) value += __shfl_xor_sync(all_lanes, value, width);
  return value;
#endif
}

}  // namespace clearance::scan
