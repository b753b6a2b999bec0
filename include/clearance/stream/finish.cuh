// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/search/conclude.hpp>
#include <clearance/search/resolve.hpp>
#include <clearance/stream/block.cuh>
#include <clearance/traversal/near_first.hpp>

namespace clearance::stream {

/// The answer from the best record: what search::resolve_body writes, without searching again.
template <class PartView, class Source>
__noinline__ __device__ void write_result(const frame_args<PartView>& a, const Source& source, const block_memory<PartView>& s) {
  const record best = s.best;
  min_distance_result out;
  real tolerance = 0;
  if (best.key != no_key) {
    const std::uint32_t point = key_index(best.key);
    const auto& body = part(a, s, best.part);
    const vec3 p = source[point].position;
    const vec3 q = body.place.part_from_cloud(p - a.origin);
    using primitive_type = typename PartView::hierarchy_type::primitive_type;
    search::nearest_primitive<primitive_type> nearest{infinity};
    const bool inside = best.primitive == none;
    if (inside)  // the way out of the solid: the closest primitive, which nobody has looked for yet
      near_first{}(body.view.tree, q, nearest);
    else
      nearest.within = key_distance(best.key), nearest.id = best.id, nearest.primitive = body.view.tree.primitives[best.primitive];
    const vec3 away = nearest.primitive.normal(q);
    out.distance = key_distance(best.key);
    out.cloud = 0, out.point = point, out.part = best.part, out.primitive = nearest.id;
    out.at = a.world_from_cloud(p);
    out.nearest = body.place.world_from_part(nearest.primitive.nearest(q));
    out.normal = body.place.world_from_part.turned(inside && nearest.within > 0 ? -away : away);
    tolerance = body.view.facts.tolerance;
  }
  search::totals all;
  for (int k = 0; k < drop_reasons; ++k) all.dropped[k] = fresh(a.state->dropped[k]);
  all.certain = fresh(a.state->certain);
  search::conclude(out, search::certain_distance(out.distance, a.slop, a.error), tolerance, all, a.error, a.points);
  *a.result = out;
}

/// Every block hands in its candidate; the last one picks the best, answers, and makes the state ready for a next frame.
template <class PartView, class Source>
__device__ void finish_block(const frame_args<PartView>& a, const Source& source, block_memory<PartView>& s) {
  const std::uint32_t t = threadIdx.x;
  frame_state& state = *a.state;
  if (t < drop_reasons && s.dropped[t] != 0) {
    atomicAdd(&state.dropped[t], static_cast<unsigned long long>(s.dropped[t]));
    __threadfence();
  }
  __syncthreads();
  if (t == 0) {
    if (s.best.key != no_key) a.records[atomicAdd(&state.records, 1u)] = s.best;
    __threadfence();
    s.last = atomicAdd(&state.done, 1u) + 1 == gridDim.x;
    s.best = {};
  }
  __syncthreads();
  if (!s.last) return;
  __threadfence();

  const std::uint32_t records = fresh(state.records);
  record mine;
  for (std::uint32_t i = t; i < records; i += block_threads) {
    const record r = a.records[i];
    if (before(r, mine)) mine = r;
  }
  atomicMin(&s.best.key, mine.key);
  __syncthreads();
  if (mine.key == s.best.key && mine.key != no_key) s.offer(mine);
  __syncthreads();
  if (t == 0) {
    write_result(a, source, s);
    if (a.done != nullptr) {
      __threadfence_system();
      *static_cast<volatile std::uint32_t*>(a.done) = a.frame;
    }
    state.bound = 0xff800000u, state.done = state.seeded = state.records = 0;
    for (int k = 0; k < drop_reasons; ++k) state.dropped[k] = 0;
    state.certain = 0;
  }
  // The best is kept first, the others as there is room.
  const std::uint32_t others = records < frame_state::kept ? records : frame_state::kept;
  if (t == 1) state.witness[0] = s.best, state.witnesses = others;
  if (t > 1 && t <= others) state.witness[t - 1] = a.records[t - 1];
}

}  // namespace clearance::stream
