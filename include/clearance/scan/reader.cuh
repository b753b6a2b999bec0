// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A block's points, four per thread and round: which they are, and why some are invalid.

#include <clearance/scan/block.cuh>

namespace clearance::scan {

inline constexpr int quad = 4;  ///< Consecutive points that a thread holds.
inline constexpr std::uint32_t in_block_round = block_threads * quad;

/// A thread's points, and why they are invalid, one byte each: a drop_reason, or `no_point`.
struct quad_points {
  vec3 at[quad];
  unsigned reasons;
};
inline constexpr unsigned no_point = 0xff;  ///< Beyond the last point of the cloud.

/// Neighbouring points are near a part together, and a block that gets many such points keeps all others waiting. So
/// pieces of points are dealt out to the blocks like cards.
template <class Tally>
class cards {
 public:
  /// Deals one row of cards after another, each from another block on. Otherwise they could all be from one column.
  explicit __device__ cards(std::uint32_t rounds) : once_(rounds == 1) {
    const std::uint32_t row = threadIdx.x / threads();
    std::uint32_t column = blockIdx.x + __umulhi(row * 0x9e3779b9u, gridDim.x);
    if (column >= gridDim.x) column -= gridDim.x;
    card_ = row * gridDim.x + column;
  }
  /// The index of this thread's first point in a round. The others follow it.
  __device__ std::uint32_t index(std::uint32_t round) const {
    return card_ * (threads() * quad) + threadIdx.x % threads() * quad + round * in_block_round * gridDim.x;
  }

 private:
  /// How many threads have neighbouring points: few, if each part has a bound and so more points are near; one, if
  /// pairs take long and nothing evens out the only round.
  __device__ std::uint32_t threads() const {
    if constexpr (!Tally::bound_per_part)
      return 4;
    else if constexpr (!Tally::goes_ahead)
      return 2;
    else if constexpr (Tally::few != 0)  // a block's first points may be the last that matter
      return 2;
    else
      return once_ ? 1 : 2;
  }

  std::uint32_t card_;
  [[maybe_unused]] bool once_;
};

/// Counts a thread's invalid points, in one byte for each of the first reasons. Other reasons go to the block's counts
/// at once, because the loop has no register left for them.
class drop_counter {
 public:
  __device__ void add(unsigned reasons, std::uint32_t (&block)[drop_reasons]) {
    static_assert(unsigned(drop_reason::not_finite) == 1);
    if ((reasons & ~0x01010101u) == 0) {
      dropped_ += __popc(reasons);
    } else {
#pragma unroll
      for (int j = 0; j < quad; ++j)
        dropped_ += __funnelshift_lc(
            0u, 1u, 8 * (reasons >> 8 * j & 0xff) - 8);  // 0, other reasons and no_point are shifted out
#pragma unroll
      for (unsigned reason = in_bytes + 1; reason < drop_reasons; ++reason)
        if (const unsigned equal = __vcmpeq4(reasons, reason * 0x01010101u); equal != 0)
          atomicAdd(&block[reason], unsigned(__popc(equal)) / 8);
    }
  }

  /// Adds this warp's counts to the block's. Call it at least every 63 rounds, before a byte overflows.
  __device__ void report(std::uint32_t (&block)[drop_reasons]) {
    if (!__any_sync(all_lanes, dropped_ != 0)) return;
    const std::uint32_t odd = sum_of(dropped_ & 0xff00ffu), even = sum_of(dropped_ >> 8 & 0xff00ffu),
                        lane = threadIdx.x & 31;
    const std::uint32_t sum = (lane % 2 == 0 ? odd : even) >> (lane & 2) * 8 & 0xffffu;
    if (lane < in_bytes && sum != 0) atomicAdd(&block[lane + 1], sum);
    dropped_ = 0;
  }

 private:
  static constexpr unsigned in_bytes = 4;
  std::uint32_t dropped_ = 0;
};

/// Reads points one by one from memory. There may be fewer than four.
template <class Source>
__device__ quad_points look_closely(const Source& source, std::uint32_t points, std::uint32_t first) {
  quad_points p;
  p.reasons = 0;
#pragma unroll
  for (std::uint32_t j = 0; j < quad; ++j) {
    sample s{{0, 0, 0}};
    const bool exists = first + j < points;
    if (exists) s = source[first + j];
    p.at[j] = s.position;
    p.reasons |= (exists ? unsigned(s.dropped) : no_point) << 8 * j;
  }
  return p;
}

}  // namespace clearance::scan
