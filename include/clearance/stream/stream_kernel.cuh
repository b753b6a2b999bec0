// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The whole frame in one kernel: a first bound, every point read once and tested against all parts' balls in its own
// frame, the few survivors against the trees. The last block to finish writes the answer.

#include <clearance/stream/finish.cuh>
#include <clearance/stream/pairs.cuh>
#include <clearance/stream/seeds.cuh>

namespace clearance::stream {

/// Parts go to shared memory: kernel arguments live behind the constant cache, a miss of which costs more than a round.
template <class PartView>
__device__ void prepare(const frame_args<PartView>& a, block_memory<PartView>& s) {
  static_assert(sizeof(stream_part<PartView>) % sizeof(std::uint32_t) == 0);
  const std::uint32_t t = threadIdx.x, inside = a.parts < inline_parts ? a.parts : inline_parts;
  const auto* from = reinterpret_cast<const std::uint32_t*>(a.part);
  auto* to = reinterpret_cast<std::uint32_t*>(s.parts);
  for (std::uint32_t i = t; i < inside * (sizeof(stream_part<PartView>) / 4); i += block_threads) to[i] = from[i];
  if (t < drop_reasons) s.dropped[t] = 0;
  if (t == 0) {
    s.bound = 0xff800000u, s.candidates = s.queued[0] = s.queued[1] = s.lock = 0;
    s.best = {};
  }
}

/// Three multiply-adds and a minimum for each point and part: which points pass any test, a bit each.
template <class PartView>
__device__ unsigned filter(const block_memory<PartView>& s, std::uint32_t parts, const quad_points& p) {
  real least[quad];
#pragma unroll
  for (int j = 0; j < quad; ++j) least[j] = infinity;
#pragma unroll 4
  for (std::uint32_t k = 0; k < parts; ++k) {
    const search::root_test root = s.roots[k];
#pragma unroll
    for (int j = 0; j < quad; ++j) least[j] = min(root.value(p.at[j]), least[j]);
  }
  unsigned passed = 0;
#pragma unroll
  for (int j = 0; j < quad; ++j) passed |= unsigned(least[j] <= -dot(p.at[j], p.at[j])) << j;
  return passed;
}

template <class PartView, class Source>
__global__ void __launch_bounds__(block_threads, 2) stream_kernel(const __grid_constant__ Source source,
                                                                  const __grid_constant__ frame_args<PartView> a) {
  __shared__ block_memory<PartView> s;
  pair_search<PartView> pairs{a, s};
  quad_reader<Source> reader(source, a.origin, a.points);
  const std::uint32_t t = threadIdx.x;
  // Neighbouring points share their fate: the chunks of 128 are dealt out, so that they meet in no block.
  constexpr std::uint32_t chunk = 32 * quad, warps = block_threads / 32;
  const std::uint32_t stride = chunk * warps * gridDim.x;
  std::uint32_t at = (t / 32 * gridDim.x + blockIdx.x) * chunk;
  quad_points p = reader.load(at);
  prepare(a, s);
  __syncthreads();
  if (!__syncthreads_or(seed_from_last_frame(a, source, s))) seed_cold(a, p, s);
  for (std::uint32_t k = t; k < a.parts; k += block_threads) s.sharpen(k, part(a, s, k).place.around);
  __syncthreads();
  for (std::uint32_t left = (a.points + stride - 1) / stride; left > 0; --left, at += stride) {
    quad_points next = p;
    if (left > 1) next = reader.load(at + stride);
    unsigned passed = filter(s, a.parts, p);
    do {
#pragma unroll
      for (int j = 0; j < quad; ++j)
        if (passed >> j & 1 && pairs.add(p.at[j], reader.index(at, j))) passed &= ~(1u << j);
      if (left == 1 || __syncthreads_or(pairs.crowded())) pairs.drain();
    } while (__syncthreads_or(passed != 0));
    p = next;
    if (t == 0) atomicMin(&s.bound, fresh(a.state->bound));
    if (t >= 32 && t - 32 < a.parts) s.sharpen(t - 32, part(a, s, t - 32).place.around);
  }
  reader.report(s.dropped);
  __syncthreads();
  finish_block(a, source, s);
}

}  // namespace clearance::stream
