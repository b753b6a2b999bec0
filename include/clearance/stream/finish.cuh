// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every block hands in its candidates; the last one answers, and makes the state ready for a next frame.

#include <clearance/stream/one_minimum.cuh>
#include <clearance/stream/part_minima.cuh>

namespace clearance::stream {

template <class PartView, bool Each, class Source>
__noinline__ __device__ void finish_block(const frame_args<PartView>& a, const Source& source) {
  auto& s = memory_of_block<PartView, Each>();
  const std::uint32_t t = threadIdx.x;
  frame_state& state = *a.state;
  if (t < drop_reasons && s.dropped[t] != 0) atomicAdd(&state.dropped[t], static_cast<unsigned long long>(s.dropped[t]));
  using end = std::conditional_t<Each, part_minima<PartView>, one_minimum<PartView>>;
  end::hand_in(a, source);
  if (t == 0) s.last = count_in(state.done) + 1 == gridDim.x;
  __syncthreads();
  if (!s.last) return;
  end::answer(a, source);
  if (a.last && t < most_parts) state.bound[t] = no_bound;
  __syncthreads();
  if (t < drop_reasons && a.last) state.dropped[t] = 0;
  if (t != 0) return;
  state.done = state.seeded = 0;
  state.witnesses = Each ? a.parts : (s.kept < 31 ? s.kept + 1 : 32);
  if (!a.last) return;
  state.certain = 0, state.best_key = no_key;
  if (a.done != nullptr) {
    __threadfence_system();
    *static_cast<volatile std::uint32_t*>(a.done) = a.number;
  }
}

}  // namespace clearance::stream
