// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/concepts.hpp>

namespace clearance::stream {

inline constexpr int quad = 4;  ///< Points that a thread has in hand.

/// A thread's points, `origin` subtracted; what is no point is NaN, which fails every comparison.
struct quad_points {
  vec3 at[quad];
};

/// Reads points four at a time, as wide as the source allows, and counts what is dropped.
template <class Source>
struct quad_reader {
  const Source& source;
  vec3 origin;
  std::uint32_t points;
  bool together;                   ///< Four in a row a thread, else a warp's width apart.
  unsigned long long dropped = 0;  ///< By reason, 16 bits each: enough for 65,535 points a thread.

  __device__ quad_reader(const Source& source, vec3 origin, std::uint32_t points) : source(source), origin(origin), points(points), together(false) {
    if constexpr (requires(sample (&out)[quad]) { source.load4(std::size_t(0), out); }) together = source.loads4();
  }

  /// Index of this thread's j-th point of the warp's chunk at `at`.
  __device__ std::uint32_t index(std::uint32_t at, int j) const {
    const std::uint32_t lane = threadIdx.x & 31;
    return at + (together ? lane * quad + j : lane + 32 * j);
  }

  __device__ quad_points load(std::uint32_t at) {
    sample s[quad];
    bool exists[quad] = {true, true, true, true};
    bool read = false;
    if constexpr (requires { source.load4(std::size_t(0), s); }) {
      read = together && at + 32 * quad <= points;
      if (read) source.load4(index(at, 0), s);
    }
    if (!read)
#pragma unroll
      for (int j = 0; j < quad; ++j) {
        const std::uint32_t i = index(at, j);
        exists[j] = i < points;
        s[j] = exists[j] ? source[i] : sample{{0, 0, 0}, drop_reason::missing};
      }
    quad_points p;
#pragma unroll
    for (int j = 0; j < quad; ++j) {
      p.at[j] = s[j].position - origin;
      if (s[j].valid()) continue;
      p.at[j].x = not_a_number;
      if (exists[j]) dropped += 1ull << 16 * (int(s[j].dropped) - 1);
    }
    return p;
  }

  /// Adds this warp's counts to the block's.
  __device__ void report(std::uint32_t (&block)[drop_reasons]) const {
    if (!__any_sync(~0u, dropped != 0)) return;
    for (int r = 1; r < drop_reasons; ++r) {
      unsigned sum = unsigned(dropped >> 16 * (r - 1)) & 0xffffu;
      for (int lanes = 16; lanes > 0; lanes /= 2) sum += __shfl_xor_sync(~0u, sum, lanes);  // any GPU; rare, so not hot
      if ((threadIdx.x & 31) == 0 && sum != 0) atomicAdd(&block[r], sum);
    }
  }
};

}  // namespace clearance::stream
