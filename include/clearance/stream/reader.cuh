// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A block's points, four a thread a round. Where they lie as one array they are copied ahead into shared memory, untouched,
// while those before them are worked on; that costs no registers, so nothing is spilled to keep a prefetch.

#include <clearance/stream/block.cuh>

namespace clearance::stream {

inline constexpr int quad = 4;     ///< Points that a thread has in hand, in a row.
inline constexpr int piece = 16;   ///< Points in a row that stay together.
inline constexpr int stages = 3;   ///< Rounds of points on their way or in work.
inline constexpr std::uint32_t pieces_of_warp = 32 * quad / piece, pieces = warps * pieces_of_warp;

/// A thread's points, less the frame's origin; what is no point is NaN, which fails every comparison.
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

/// Why four points do not count, a byte each: a drop_reason, or that there is none; or that it takes more to tell.
inline constexpr unsigned no_point = 0xff, unknown = ~0u;

/// Neighbouring points share their fate, and a block that gets many that are near some part keeps all others waiting: so
/// the pieces are dealt out to the blocks like cards. `Before`: bytes of shared memory before its own.
template <class Source, std::size_t Before>
class point_reader {
 public:
  static constexpr bool wide = requires { typename Source::raw4; };
  using raw4 = typename raw_of<Source>::type;

  __device__ point_reader(const Source& source, std::uint32_t points, bool ring) : source_(source), points_(points) {
    // A row of cards after the other, each dealt from another block on: else a block's cards could all be of one column.
    const std::uint32_t row = threadIdx.x / 32 * pieces_of_warp + lane() / lanes_of_piece;
    const std::uint32_t card = row * gridDim.x + (blockIdx.x + row * 0x9e37u) % gridDim.x;
    first_ = card * piece + lane() % lanes_of_piece * quad;
    if constexpr (wide) whole_ = ring && source.fours() != nullptr ? points / piece * piece : 0;
  }

  /// Rounds until every point has been read by some block.
  __device__ std::uint32_t rounds() const { return (points_ + in_round() - 1) / in_round(); }

  /// Of this thread's first point in a round; the others follow it.
  __device__ std::uint32_t index(std::uint32_t round) const { return first_ + round * in_round(); }

  /// Starts the copy of a round's points; past the last round there is nothing to copy.
  __device__ void fetch(std::uint32_t round) const {
    if constexpr (wide) {
      __syncwarp();  // the warp has done with the stage
      const std::uint32_t first = index(round), of_lane = lane() % lanes_of_piece;
      if (first < whole_ && of_lane < copying) {
        const char* const from = reinterpret_cast<const char*>(source_.fours()) + (std::size_t(first / piece) * steps_of_piece + of_lane) * step;
        char* const to = reinterpret_cast<char*>(stage(round)) + (lane() / lanes_of_piece * steps_of_piece + of_lane) * step;
#pragma unroll
        for (std::uint32_t j = 0; j < steps_of_piece; j += copying) __pipeline_memcpy_async(to + j * step, from + j * step, step);
      }
      __pipeline_commit();
    }
  }

  /// This thread's points of a round; `stages - 1` rounds may have been fetched since. `again`: not the first time, and only
  /// those of `which`, a bit each.
  __device__ quad_points take(std::uint32_t round, bool again, unsigned which) {
    const std::uint32_t first = index(round);
    quad_points p;
    unsigned reasons = unknown;
    if constexpr (wide)
      if (!again) {
        __pipeline_wait_prior(stages - 1);
        __syncwarp();
        if (first < whole_) reasons = source_.positions4(stage(round)[lane()], first, p.at);
      }
    if (reasons == unknown) reasons = look_closely(first, p);
    if (reasons != 0) leave_out(p, reasons);
    if (!again) {
      if (reasons != 0) count(reasons);
    } else {
      for (int j = 0; j < quad; ++j)
        if ((which >> j & 1) == 0) p.at[j].x = not_a_number;
    }
    return p;
  }

  /// The first round's points, which have been waited for; nothing is counted.
  __device__ quad_points peek() const {
    quad_points p;
    unsigned reasons = unknown;
    if constexpr (wide)
      if (first_ < whole_) reasons = source_.positions4(stage(0)[lane()], first_, p.at);
    if (reasons == unknown) reasons = look_closely(first_, p);
    if (reasons != 0) leave_out(p, reasons);
    return p;
  }

  /// Adds this warp's counts to the block's; due before 63 rounds are over, or a byte is full.
  __device__ void report(std::uint32_t (&block)[drop_reasons]) {
    if (!__any_sync(all_lanes, dropped_ != 0)) return;
    const std::uint32_t odd = sum_of(dropped_ & 0xff00ffu), even = sum_of(dropped_ >> 8 & 0xff00ffu);
    const std::uint32_t sum = (lane() % 2 == 0 ? odd : even) >> (lane() & 2) * 8 & 0xffffu;
    if (lane() + 1 < drop_reasons && sum != 0) atomicAdd(&block[lane() + 1], sum);
    dropped_ = 0;
  }

 private:
  static_assert(drop_reasons <= 5);
  __device__ unsigned look_closely(std::uint32_t first, quad_points& p) const {
    unsigned reasons = 0;
#pragma unroll
    for (std::uint32_t j = 0; j < quad; ++j) {
      sample s{{0, 0, 0}};
      const bool exists = first + j < points_;
      if (exists) s = source_[first + j];
      p.at[j] = s.position, reasons |= (exists ? unsigned(s.dropped) : no_point) << 8 * j;
    }
    return reasons;
  }
  static __device__ void leave_out(quad_points& p, unsigned reasons) {
#pragma unroll
    for (int j = 0; j < quad; ++j) p.at[j].x = (reasons >> 8 * j & 0xff) == 0 ? p.at[j].x : not_a_number;
  }
  __device__ void count(unsigned reasons) {
#pragma unroll
    for (int j = 0; j < quad; ++j)
      dropped_ += __funnelshift_lc(0u, 1u, 8 * (reasons >> 8 * j & 0xff) - 8);  // a byte a reason; 0 and no_point are shifted out
  }

  /// Copies go in steps of 16 bytes; as many lanes of those that will look at a piece take part as evenly can.
  static constexpr std::uint32_t step = 16, lanes_of_piece = piece / quad, steps_of_piece = lanes_of_piece * sizeof(raw4) / step;
  static constexpr std::uint32_t copying = steps_of_piece < lanes_of_piece ? steps_of_piece : lanes_of_piece;
  static_assert(steps_of_piece % copying == 0);

  static __device__ std::uint32_t lane() { return threadIdx.x & 31; }
  static __device__ std::uint32_t in_round() { return piece * pieces * gridDim.x; }
  /// Where this warp's points of a round come to lie, behind the block's other memory.
  static __device__ raw4* stage(std::uint32_t round) {
    extern __shared__ __align__(16) std::byte stream_memory[];
    return reinterpret_cast<raw4*>(stream_memory + Before) + round % stages * block_threads + threadIdx.x / 32 * 32;
  }

  const Source& source_;
  std::uint32_t points_, first_;
  std::uint32_t whole_ = 0;  ///< Points in whole pieces that are copied ahead.
  std::uint32_t dropped_ = 0;
};

}  // namespace clearance::stream
