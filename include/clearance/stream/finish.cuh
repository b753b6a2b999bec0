// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every block hands in its candidates; the last one answers, and makes the state ready for a next frame.

#include <clearance/search/conclude.hpp>
#include <clearance/search/resolve.hpp>
#include <clearance/stream/best.cuh>
#include <clearance/traversal/near_first.hpp>

namespace clearance::stream {

/// What a record is about, read before it is known whether the record is the best: the answer then waits for nothing.
template <class PartView, bool Each>
struct evidence {
  using primitive_type = typename PartView::hierarchy_type::primitive_type;
  using parts = frame_parts<PartView, Each>;

  record r;
  vec3 p;  ///< In the cloud's frame.
  primitive_type primitive;
  world_transform world;

  evidence() = default;
  template <class Source>
  __device__ evidence(const frame_args<PartView>& a, const Source& source, const record& of) : r(of) {
    if (r.key == no_key || key_index(r.key) < a.first) return;
    if (r.primitive != none) primitive = far(parts::view(r.part).tree.primitives + r.primitive);
    p = source[key_index(r.key) - a.first].position;
    if (a.far)
      world = a.rest->world_from_part[r.part];
    else
      world = a.world_from_part[r.part];
  }
  __device__ vec3 in_part() const { return parts::place(r.part).part_from_cloud(p - parts::here().origin); }

  /// Of a point inside a solid the closest primitive, which nobody has looked for yet; how far it is.
  __device__ real complete() {
    if constexpr (!requires { PartView::interior_type::empty; })
      if (r.primitive == none) {
        search::nearest_primitive<primitive_type> nearest{infinity};
        near_first{}(parts::view(r.part).tree, in_part(), nearest);
        r.id = nearest.id, primitive = nearest.primitive;
        return nearest.within;
      }
    return 0;
  }
};

template <class PartView, bool Each>
__device__ void write_witness(const frame_args<PartView>& a, evidence<PartView, Each> e) {
  min_distance_result& out = *a.result;
  const real way_out = e.complete();
  const vec3 q = e.in_part(), away = e.primitive.normal(q);
  out.cloud = a.cloud, out.point = key_index(e.r.key) - a.first, out.part = e.r.part, out.primitive = e.r.id;
  out.at = a.placed ? a.rest->frame.world_from_cloud(e.p) : a.frame.world_from_cloud(e.p);
  out.nearest = e.world(e.primitive.nearest(q));
  out.normal = e.world.turned(way_out > 0 ? -away : away);
}

/// Counts, bracket and state, once all clouds are done; and a blank witness if there is no minimum.
template <class PartView, bool Each>
__device__ void write_bracket(const frame_args<PartView>& a, const record& best, const search::totals& all) {
  using parts = frame_parts<PartView, Each>;
  const auto& s = parts::here();
  const search::frame_facts& frame = a.facts();
  min_distance_result r;
  double lower = -infinity;
  real tolerance = 0;
  min_distance_result& out = *a.result;
  if (best.key != no_key) {
    r.distance = key_distance(best.key), r.part = best.part;
    tolerance = parts::view(best.part).facts.tolerance;
    lower = search::certain_distance(r.distance, frame.slop, frame.error);
    if constexpr (Each) {
      lower = infinity;
      for (std::uint32_t k = 0; k < a.parts; ++k) {
        const double its = search::certain_distance(key_distance(s.best[k].key), search::slop(parts::view(k).facts), frame.error);
        lower = its < lower ? its : lower;
      }
    }
  } else {
    out = r;
  }
  search::conclude(r, lower, tolerance, all, frame.error, std::uint64_t(a.first) + a.points);
  if (!s.rigid) r.state = state::possible;  // nothing is known where a pose on the device is none: this stops a robot
  out.state = r.state, out.distance = r.distance, out.lower = r.lower, out.upper = r.upper, out.seen = r.seen, out.valid = r.valid;
  for (int k = 0; k < drop_reasons; ++k) out.dropped[k] = r.dropped[k];
}

/// The best of all blocks' records and of earlier clouds', slot by slot, to s.best, or to all threads if there is one slot;
/// what is behind one, if it is this thread's (the first lanes of warp w have slots w, w + 16, ...).
template <class PartView, bool Each, class Source>
__device__ evidence<PartView, Each> merge(const frame_args<PartView>& a, const Source& source, record& best) {
  auto& s = memory_of_block<PartView, Each>();
  const std::uint32_t t = threadIdx.x, lane = t & 31;
  const auto earlier = [&](std::uint32_t slot) { return a.first > 0 ? a.state->best[slot] : record{}; };
  if constexpr (Each) {
    record its;
    for (std::uint32_t slot = t / 32, k = 0; slot < a.parts; slot += warps, ++k) {
      record least = earlier(slot);
#pragma unroll 4
      for (std::uint32_t b = lane; b < gridDim.x; b += 32)
        if (const record r = a.records[slot * gridDim.x + b]; before(r, least)) least = r;
      least = least_of_warp(least);
      if (lane == k) its = least, s.best[slot] = least;
    }
    const evidence<PartView, Each> mine(a, source, s.rigid ? its : record{});
    __syncthreads();
    record least;
    for (std::uint32_t k = lane; k < a.parts; k += 32)
      if (before(s.best[k], least)) least = s.best[k];
    best = least_of_warp(least);
    return mine;
  } else {
    record least = t < gridDim.x ? a.records[t] : record{};
    for (std::uint32_t b = t + block_threads; b < gridDim.x; b += block_threads)
      if (const record r = a.records[b]; before(r, least)) least = r;
    const evidence<PartView, Each> mine(a, source, least);
    least = least_of_warp(least);
    if (lane == 0) s.best_of_warp[t / 32] = least;
    __syncthreads();
    best = least_of_warp(lane < warps ? s.best_of_warp[lane] : lane == warps ? earlier(0) : record{});
    return mine;
  }
}

/// The answer, by a thread each for what does not depend on one another.
template <class PartView, bool Each, class Source>
__device__ void answer(const frame_args<PartView>& a, const Source& source) {
  auto& s = memory_of_block<PartView, Each>();
  frame_state& state = *s.head.state;
  const std::uint32_t t = threadIdx.x;
  search::totals all;
  const bool concludes = t == block_threads - 32 && a.last;
  if (concludes) {
    for (int k = 0; k < drop_reasons; ++k) all.dropped[k] = fresh(state.dropped[k]);
    all.certain = fresh(state.certain);
  }
  record best;
  evidence<PartView, Each> mine = merge<PartView, Each>(a, source, best);
  if (!s.rigid) best = {};
  const bool mine_here = mine.r.key != no_key && key_index(mine.r.key) >= a.first;
  const bool won = mine_here && mine.r.key == best.key && mine.r.part == best.part && mine.r.id == best.id;
  if (won) write_witness(a, mine);
  if (concludes) write_bracket<PartView, Each>(a, best, all);
  // Kept for the next frame: every part's minimum, or the best and others as there is room.
  if constexpr (Each) {
    if (const std::uint32_t slot = t / 32 + warps * (t & 31); slot < a.parts) {
      state.best[slot] = s.best[slot];
      if (mine_here) {
        a.witnesses[slot] = {mine.r, mine.primitive};
        mine.complete();
        a.minima[slot] = {key_distance(mine.r.key), a.cloud, key_index(mine.r.key) - a.first, mine.r.id};
      } else if (mine.r.key == no_key) {
        a.witnesses[slot].r = {}, a.minima[slot] = {};
      }
    }
  } else {
    if (t == 0) state.best[0] = best;
    if (mine_here)
      if (const std::uint32_t place = won ? 0 : atomicAdd(&s.children, 1u) + 1; place < 32) a.witnesses[place] = {mine.r, mine.primitive};
    if (t == 0 && best.key == no_key) a.witnesses[0].r = {};
  }
  if (a.last && t < most_parts) state.bound[t] = no_bound;
}

template <class PartView, bool Each, class Source>
__noinline__ __device__ void finish_block(const frame_args<PartView>& a, const Source& source) {
  auto& s = memory_of_block<PartView, Each>();
  const std::uint32_t t = threadIdx.x, slots = Each ? a.parts : 1;
  frame_state& state = *s.head.state;
  if (t < drop_reasons && s.dropped[t] != 0) atomicAdd(&state.dropped[t], static_cast<unsigned long long>(s.dropped[t]));
  if constexpr (Each) {
    if (t < slots) s.head.records[t * gridDim.x + blockIdx.x] = s.best[t];
    __syncthreads();
  } else if (t < 32) {
    const record best = least_of_warp(t < warps ? s.best_of_warp[t] : s.best[0]);
    if (t == 0) s.head.records[blockIdx.x] = best;
    __syncwarp();
  }
  if (t == 0) s.last = count_in(state.done) + 1 == gridDim.x;
  __syncthreads();
  if (!s.last) return;
  answer<PartView, Each>(a, source);
  __syncthreads();
  if (t < drop_reasons && a.last) state.dropped[t] = 0;
  if (t != 0) return;
  state.done = state.seeded = 0;
  state.witnesses = Each ? slots : (s.children < 31 ? s.children + 1 : 32);
  if (!a.last) return;
  state.certain = 0;
  if (a.done != nullptr) {
    __threadfence_system();
    *static_cast<volatile std::uint32_t*>(a.done) = a.number;
  }
}

}  // namespace clearance::stream
