// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/search/conclude.hpp>
#include <clearance/search/resolve.hpp>
#include <clearance/stream/block.cuh>
#include <clearance/traversal/near_first.hpp>

namespace clearance::stream {

/// What a record is about, read before it is known whether the record is the best: the answer then waits for nothing.
template <class PartView>
struct evidence {
  using primitive_type = typename PartView::hierarchy_type::primitive_type;

  record r;
  vec3 p;  ///< In the cloud's frame.
  primitive_type primitive;

  evidence() = default;
  template <class Source, bool Each>
  __device__ evidence(const frame_args<PartView>& a, const Source& source, const block_memory<PartView, Each>& s, const record& of) : r(of) {
    if (r.key == no_key || key_index(r.key) < a.first) return;
    p = source[key_index(r.key) - a.first].position;
    if (r.primitive != none) primitive = part(a, s, r.part).view.tree.primitives[r.primitive];
  }
  template <bool Each>
  __device__ vec3 in_part(const frame_args<PartView>& a, const block_memory<PartView, Each>& s) const {
    return part(a, s, r.part).place.part_from_cloud(p - s.frame.origin);
  }
  /// Of a point inside a solid the closest primitive, which nobody has looked for yet; how far it is.
  template <bool Each>
  __device__ real complete(const frame_args<PartView>& a, const block_memory<PartView, Each>& s) {
    if constexpr (!requires { PartView::interior_type::empty; })
      if (r.primitive == none) {
        search::nearest_primitive<primitive_type> nearest{infinity};
        near_first{}(part(a, s, r.part).view.tree, in_part(a, s), nearest);
        r.id = nearest.id, primitive = nearest.primitive;
        return nearest.within;
      }
    return 0;
  }
};

template <class PartView, bool Each>
__device__ void write_witness(const frame_args<PartView>& a, const block_memory<PartView, Each>& s, evidence<PartView> e) {
  min_distance_result& out = *a.result;
  const real way_out = e.complete(a, s);
  const vec3 q = e.in_part(a, s), away = e.primitive.normal(q);
  const world_transform& world = part(a, s, e.r.part).place.world_from_part;
  out.cloud = a.cloud, out.point = key_index(e.r.key) - a.first, out.part = e.r.part, out.primitive = e.r.id;
  out.at = s.frame.world_from_cloud(e.p);
  out.nearest = world(e.primitive.nearest(q));
  out.normal = world.turned(way_out > 0 ? -away : away);
}

/// Counts, bracket and state, once all clouds are done; and a blank witness if there is no minimum.
template <class PartView, bool Each>
__device__ void write_bracket(const frame_args<PartView>& a, const block_memory<PartView, Each>& s, const record& best,
                              const search::totals& all) {
  min_distance_result r;
  double lower = -infinity;
  real tolerance = 0;
  min_distance_result& out = *a.result;
  if (best.key != no_key) {
    r.distance = key_distance(best.key), r.part = best.part;
    tolerance = part(a, s, best.part).view.facts.tolerance;
    lower = search::certain_distance(r.distance, s.frame.slop, s.frame.error);
    if constexpr (Each) {
      lower = infinity;
      for (std::uint32_t k = 0; k < a.parts; ++k) {
        const double its = search::certain_distance(key_distance(s.best[k].key), search::slop(part(a, s, k).view.facts), s.frame.error);
        lower = its < lower ? its : lower;
      }
    }
  } else {
    out = r;
  }
  search::conclude(r, lower, tolerance, all, s.frame.error, std::uint64_t(a.first) + a.points);
  if (!s.rigid) r.state = state::possible;  // nothing is known where a pose on the device is none: this stops a robot
  out.state = r.state, out.distance = r.distance, out.lower = r.lower, out.upper = r.upper, out.seen = r.seen, out.valid = r.valid;
  for (int k = 0; k < drop_reasons; ++k) out.dropped[k] = r.dropped[k];
}

/// Of all records the best of each slot; then the answer, by a thread each for what does not depend on one another.
template <class PartView, bool Each, class Source>
__device__ void answer(const frame_args<PartView>& a, const Source& source, block_memory<PartView, Each>& s) {
  const std::uint32_t t = threadIdx.x, slots = Each ? a.parts : 1, count = gridDim.x * slots;
  evidence<PartView> mine(a, source, s, t < count ? a.records[t] : record{});
  search::totals all;
  const bool concludes = t == block_threads - 32 && a.last;
  if (concludes) {
    for (int k = 0; k < drop_reasons; ++k) all.dropped[k] = fresh(a.state->dropped[k]);
    all.certain = fresh(a.state->certain);
  }
  if (t < slots) s.best[t] = a.first > 0 ? a.state->best[t] : record{}, s.least[t] = s.best[t].key;
  __syncthreads();
  const auto merge = [&](const record& r, std::uint32_t i) {
    if (r.key < fresh(s.least[i % slots])) atomicMin(&s.least[i % slots], r.key);
    __syncthreads();
    if (r.key != no_key && r.key == s.least[i % slots]) s.offer(r);
    __syncthreads();
  };
  merge(mine.r, t);
  for (std::uint32_t base = block_threads; base < count; base += block_threads)
    merge(base + t < count ? a.records[base + t] : record{}, base + t);
  record best = s.best[0];
  for (std::uint32_t k = 1; k < slots; ++k)
    if (before(s.best[k], best)) best = s.best[k];
  if (!s.rigid) best = {};
  const auto is = [](const record& x, const record& y) { return x.key == y.key && x.part == y.part && x.id == y.id; };
  const bool here = best.key != no_key && key_index(best.key) >= a.first;
  if constexpr (!Each) {
    if (here && is(mine.r, best)) write_witness(a, s, mine);
  } else {
    if (here && t == block_threads - 1) write_witness(a, s, evidence<PartView>(a, source, s, best));
    if (t < a.parts) {
      evidence<PartView> own(a, source, s, s.rigid ? s.best[t] : record{});
      if (own.r.key == no_key) {
        a.minima[t] = {};
      } else if (key_index(own.r.key) >= a.first) {
        own.complete(a, s);
        a.minima[t] = {key_distance(own.r.key), a.cloud, key_index(own.r.key) - a.first, own.r.id};
      }
    }
  }
  if (concludes) write_bracket(a, s, best, all);
}

/// Every block hands in its candidates; the last one answers, and makes the state ready for a next frame.
template <class PartView, bool Each, class Source>
__device__ void finish_block(const frame_args<PartView>& a, const Source& source, block_memory<PartView, Each>& s) {
  const std::uint32_t t = threadIdx.x, slots = Each ? a.parts : 1;
  frame_state& state = *a.state;
  if (t < drop_reasons && s.dropped[t] != 0) atomicAdd(&state.dropped[t], static_cast<unsigned long long>(s.dropped[t]));
  if (t < slots) a.records[blockIdx.x * slots + t] = s.best[t];
  __syncthreads();
  if (t == 0) {
    __threadfence();
    s.last = atomicAdd(&state.done, 1u) + 1 == gridDim.x;
  }
  __syncthreads();
  if (!s.last) return;
  __threadfence();
  answer(a, source, s);
  // Kept for the next frame: every part's minimum, or the best and others as there is room.
  if (t == 0) s.pairs = Each ? slots : 1;
  __syncthreads();
  if (t < slots) state.best[t] = state.witness[t] = s.best[t];
  if (!Each && t < gridDim.x)
    if (const record r = a.records[t]; r.key != no_key)
      if (const std::uint32_t place = atomicAdd(&s.pairs, 1u); place < 32) state.witness[place] = r;
  if (a.last && t < most_parts) state.bound[t] = no_bound;
  if (a.last && t < drop_reasons) state.dropped[t] = 0;
  __syncthreads();
  if (t == 0) {
    state.done = state.seeded = 0;
    state.witnesses = Each ? slots : (s.pairs < 32 ? s.pairs : 32);
    if (a.last) state.certain = 0;
    if (a.last && a.done != nullptr) {
      __threadfence_system();
      *static_cast<volatile std::uint32_t*>(a.done) = a.number;
    }
  }
}

}  // namespace clearance::stream
