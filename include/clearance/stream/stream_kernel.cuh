// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud in one kernel: a first bound, every point read once and tested against the parts' balls in its own frame, the few
// near ones against the trees. The last block to finish writes the answer.

#include <clearance/stream/filter.cuh>
#include <clearance/stream/finish.cuh>
#include <clearance/stream/seeds.cuh>

namespace clearance::stream {

inline constexpr std::uint32_t batch = 8;  ///< Rounds between two looks at what others have found.

template <class PartView, bool Each, class Source>
constexpr std::size_t shared_bytes(bool ring) {
  constexpr std::size_t fixed = (sizeof(block_memory<PartView, Each>) + 15) / 16 * 16;
  return fixed + (ring ? ring_bytes<Source>() : 0);
}

/// Points that found no room before a drain are read again, for one cluster of parts at a time: that is little enough for
/// some always to find room. It is rare.
template <class PartView, bool Each, class Source>
__noinline__ __device__ unsigned hand_over_again(pair_search<PartView, Each> pairs, const point_reader<Source> reader, const Source& source,
                                                 std::uint32_t round, unsigned missed, std::uint32_t c) {
  unsigned still = 0;
  for (std::uint32_t r = 0; r < batch; ++r) {
    const unsigned which = missed >> quad * r & 0xf;
    if (!__any_sync(all_lanes, which != 0)) continue;
    const std::uint32_t first = reader.index(round + r);
    quad_points p;
    for (std::uint32_t j = 0; j < quad; ++j)
      p.at[j] = which >> j & 1 ? source[first + j].position - pairs.s.frame.origin : vec3{not_a_number, 0, 0};
    still |= hand_over(pairs, p, [=] { return first; }, c, c + 1) << quad * r;
  }
  return still;
}

template <class PartView, bool Each, class Source>
__global__ void __launch_bounds__(block_threads, 2) stream_kernel(const __grid_constant__ Source source,
                                                                  const __grid_constant__ frame_args<PartView> a) {
  extern __shared__ __align__(16) std::byte memory[];
  auto& s = *reinterpret_cast<block_memory<PartView, Each>*>(memory);
  using reader_type = point_reader<Source>;
  auto* const ring = reinterpret_cast<typename reader_type::raw4*>(memory + shared_bytes<PartView, Each, Source>(false));
  reader_type reader(source, a.points, a.ring ? ring : nullptr);
  pair_search<PartView, Each> pairs{a, s};
  const std::uint32_t t = threadIdx.x, rounds = reader.rounds(), clusters = (a.parts + cluster - 1) / cluster;
  const last_frame<PartView, Each> before(*a.state);
  reader.fetch(0);
  prepare(a, s);
  __syncthreads();
  const top_level top(a, s);
  before.seed(a, source, s);
  for (std::uint32_t r = 1; r + 1 < stages; ++r) reader.fetch(r);  // not before the seeds, which would wait behind them
  top.put(s);
  __syncthreads();
  if (__syncthreads_or(t < (Each ? a.parts : 1) && s.bound[t] == no_bound) && rounds > 0) {
    reader.fetch(stages - 1);
    seed_cold(a, reader.take(0, s.frame.origin), s);
    reader.forget_counts();
    __syncthreads();
  }
  sharpen(a, s, t);
  __syncthreads();
  for (std::uint32_t first = 0; first < rounds; first += batch) {
    const std::uint32_t end = first + batch < rounds ? first + batch : rounds;
    unsigned missed = 0;
    for (std::uint32_t r = first; r < end; ++r) {
      reader.fetch(r + stages - 1);
      const quad_points p = reader.take(r, s.frame.origin);
      missed |= hand_over(pairs, p, [&] { return reader.index(r); }, 0, clusters) << quad * (r - first);
    }
    if (first / batch % 7 == 6) reader.report(s.dropped);
    if (__syncthreads_or(missed != 0))
      for (std::uint32_t c = 0; c < clusters; ++c)
        for (unsigned left = missed; __syncthreads_or(left != 0);) {
          pairs.drain();
          refresh(a, s);
          left = hand_over_again(pairs, reader, source, first, left, c);
        }
    if (end == rounds || pairs.crowded()) pairs.drain();
    if (end != rounds) refresh(a, s);
  }
  reader.report(s.dropped);
  __syncthreads();
  finish_block(a, source, s);
}

}  // namespace clearance::stream
