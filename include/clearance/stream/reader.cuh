// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A block's points, four a thread a round. Where they lie as one array they are copied ahead into shared memory, untouched,
// while those before them are worked on; that costs no registers, so nothing is spilled to keep a prefetch.

#include <clearance/stream/block.cuh>

#include <cuda_pipeline.h>

namespace clearance::stream {

inline constexpr int quad = 4;     ///< Points that a thread has in hand, in a row.
inline constexpr int piece = 16;   ///< Points in a row that stay together.
inline constexpr int stages = 3;   ///< Rounds of points on their way or in work.
inline constexpr std::uint32_t warps = block_threads / 32, pieces = block_threads * quad / piece;

/// Points with `origin` subtracted; what is no point is NaN, which fails every comparison.
struct quad_points {
  vec3 at[quad];
};

template <class Source>
struct raw_of {
  struct alignas(16) type {};
};
template <class Source>
  requires requires { typename Source::raw4; }
struct raw_of<Source> {
  using type = typename Source::raw4;
};

/// Bytes of shared memory for the points of a source on their way.
template <class Source>
constexpr std::size_t ring_bytes() {
  if constexpr (requires { typename Source::raw4; }) return stages * block_threads * sizeof(typename Source::raw4);
  return 0;
}

/// Neighbouring points share their fate, and a block that gets many that are near some part keeps all others waiting: so
/// the pieces are dealt out to the blocks like cards.
template <class Source>
class point_reader {
 public:
  static constexpr bool wide = requires { typename Source::raw4; };
  using raw4 = typename raw_of<Source>::type;

  __device__ point_reader(const Source& source, std::uint32_t points, raw4* ring) : source_(source), points_(points) {
    if constexpr (wide) {
      if (ring != nullptr) mine_ = ring + threadIdx.x / 32 * 32, fours_ = source.fours();
    }
  }

  /// Rounds until every point has been read by some block.
  __device__ std::uint32_t rounds() const {
    const std::uint32_t in_round = piece * pieces * gridDim.x;
    return (points_ + in_round - 1) / in_round;
  }

  /// Of this thread's first point in a round; the others follow it.
  __device__ std::uint32_t index(std::uint32_t round) const {
    return first_of(round, (threadIdx.x & 31) / (piece / quad)) + threadIdx.x % (piece / quad) * quad;
  }

  /// Starts the copy of a round's points; past the last round there is nothing to copy.
  __device__ void fetch(std::uint32_t round) {
    if constexpr (wide) {
      __syncwarp();  // the warp has done with the stage
      constexpr std::uint32_t step = 16, of_piece = piece / quad * sizeof(raw4) / step, of_warp = 32 * sizeof(raw4) / step;
      char* const to = reinterpret_cast<char*>(mine_ + round % stages * block_threads);
#pragma unroll
      for (std::uint32_t base = 0; base < of_warp; base += 32) {
        const std::uint32_t n = base + (threadIdx.x & 31);
        const std::uint32_t from = first_of(round, n / of_piece);
        if ((base + 32 <= of_warp || n < of_warp) && fours_ != nullptr && from + piece <= points_)
          __pipeline_memcpy_async(to + n * step, reinterpret_cast<const char*>(fours_ + from / quad) + n % of_piece * step, step);
      }
      __pipeline_commit();
    }
  }

  /// This thread's points of a round; `stages - 1` rounds may have been fetched since.
  __device__ quad_points take(std::uint32_t round, vec3 origin) {
    const std::uint32_t first = index(round);
    sample s[quad];
    if constexpr (wide) {
      __pipeline_wait_prior(stages - 1);
      __syncwarp();
    }
    if (wide && fours_ != nullptr && first / piece * piece + piece <= points_) {
      if constexpr (wide) source_.look4(mine_[round % stages * block_threads + (threadIdx.x & 31)], first, s);
    } else {
#pragma unroll
      for (std::uint32_t j = 0; j < quad; ++j) {
        s[j] = {{not_a_number, 0, 0}, drop_reason::none};
        if (first + j < points_) s[j] = source_[first + j];
      }
    }
    quad_points p;
    bool all = true;
#pragma unroll
    for (int j = 0; j < quad; ++j) {
      p.at[j] = s[j].position - origin;
      if (!s[j].valid()) p.at[j].x = not_a_number, all = false;
    }
    if (!all)
#pragma unroll
      for (int j = 0; j < quad; ++j) dropped_ += s[j].valid() ? 0 : 1u << (8 * int(s[j].dropped) - 8);  // a byte a reason
    return p;
  }

  __device__ void forget_counts() { dropped_ = 0; }

  /// Adds this warp's counts to the block's; due every 60 rounds, before a byte is full.
  __device__ void report(std::uint32_t (&block)[drop_reasons]) {
    if (!__any_sync(all_lanes, dropped_ != 0)) return;
    for (int r = 1; r < drop_reasons; ++r) {
      unsigned sum = dropped_ >> 8 * (r - 1) & 0xffu;
      for (int width = 16; width > 0; width /= 2) sum += __shfl_xor_sync(all_lanes, sum, width);
      if ((threadIdx.x & 31) == 0 && sum != 0) atomicAdd(&block[r], sum);
    }
    dropped_ = 0;
  }

 private:
  static constexpr std::uint32_t of_a_warp = pieces / warps;

  __device__ std::uint32_t first_of(std::uint32_t round, std::uint32_t k) const {
    return (((round * warps + threadIdx.x / 32) * of_a_warp + k) * gridDim.x + blockIdx.x) * piece;
  }

  const Source& source_;
  std::uint32_t points_;
  raw4* mine_ = nullptr;
  const raw4* fours_ = nullptr;
  std::uint32_t dropped_ = 0;
};

}  // namespace clearance::stream
