// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The end of a scan on a device: its last block gives the answer and prepares the next scan.

#include <clearance/result.hpp>
#include <clearance/scan/block.cuh>
#include <clearance/scan/drops.hpp>

namespace clearance::scan {

/// Counts this block as done. The last block gives the answer and prepares everything for the next scan.
template <class Tally, class Source>
__noinline__ __device__ void finish_block(const scan_arguments<Tally>& a, const Source& source) {
  auto& s = memory_of_block<Tally>();
  const std::uint32_t t = threadIdx.x;
  scan_state& state = *a.state;
  if (t < drop_reasons && s.dropped[t] != 0)
    atomicAdd(&state.dropped[t], static_cast<unsigned long long>(s.dropped[t]));
  __syncwarp();  // thread 0 counts this block as done, and so must come after these
  Tally::hand_in(a, source);
  if (t == 0) s.last = count_in(state.done) + 1 == gridDim.x;
  __syncthreads();
  if (!s.last) return;
  Tally::conclude(a, source);
  __syncthreads();
  if (t < drop_reasons && a.last) state.dropped[t] = 0;
  if (t != 0) return;
  state.done = state.taken = 0;
  Tally::reset(a);
  if (a.last && a.done != nullptr) {
    __threadfence_system();
    *static_cast<volatile std::uint32_t*>(a.done) = a.number;
  }
}

/// Writes the point counts after the last cloud, with one thread of the last block. `counts` may be null.
template <class Tally>
__device__ void write_counts(const scan_arguments<Tally>& a, point_counts* counts) {
  if (threadIdx.x != 0 || !a.last || counts == nullptr) return;
  unsigned long long dropped[drop_reasons];
  for (int k = 0; k < drop_reasons; ++k) dropped[k] = fresh(a.state->dropped[k]);
  count(*counts, dropped, std::uint64_t(a.first) + a.points);
}

}  // namespace clearance::scan
