// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A bound before the first test, from what a device keeps of the last frame or from a few points. Any real pair of a
// point and a primitive gives a valid one, so nothing can be lost.

#include <clearance/result.hpp>
#include <clearance/scan/arguments.hpp>
#include <clearance/scan/reader.cuh>
#include <clearance/scan/steps.cuh>

namespace clearance::minimum {

// What a device keeps about a minimum, within a frame and for the next one.

using scan::no_bound;

using scan::record, scan::before, scan::same;

/// A minimum of the last frame, which gives this frame's first bound.
template <class Record, class Primitive>
struct witness {
  Record r;
  Primitive primitive;
};

/// Lives in device memory from frame to frame. The last block of a frame resets all but the number of witnesses. If all
/// parts share a bound, it is in slot 0, and part k's own, if it may decide what is certain, in slot 1 + k; otherwise
/// each part has its own slot.
template <class Record>
struct device_state {
  std::uint32_t bound[scan::most_parts + 1];  ///< ordered() upper bounds of this frame, shared by all blocks.
  Record best[scan::most_parts];              ///< Minima over the finished clouds,
  distance_key best_key = no_key;             ///< and over the finished blocks, if all parts share a bound.
  std::uint32_t witnesses = 0;
  std::uint32_t seeded = 0;  ///< Blocks that have seeded (cold frames only).
  unsigned long long certain = 0;

  device_state() {
    for (auto& b : bound) b = no_bound;
  }
};

/// The answer without the counts, if a block's best is the best of all.
struct draft {
  position at, nearest;
  vec3 normal;
  std::uint32_t primitive, part;
  clearance::state state;
  real distance, lower, upper;
};

using scan::all_lanes, scan::fresh, scan::least_of, scan::lower_of, scan::memory_of_block, scan::block_threads,
    scan::warps;

/// Evaluates last frame's minima and their neighbours anew: sixteen threads per minimum, or four if each part has one.
/// None of it needs shared memory to be ready.
template <class Tally>
class last_frame {
 public:
  /// Starts to read the last minima; nothing waits for them yet.
  explicit __device__ last_frame(const scan::scan_arguments<Tally>& a)
      : w_(a.answer.witnesses[slot()]), witnesses_(a.answer.state->witnesses) {
    if (a.first != 0 && slot() < (per_part ? a.parts : 1)) known_ = fresh(a.answer.state->bound[slot()]);
  }

  /// Reads the points of those minima and their neighbours.
  template <class Source>
  __device__ void seed_from(const scan::scan_arguments<Tally>& a, const Source& source) {
    const std::uint32_t point = its_point(a);
    const bool live =
        a.parts > w_.r.part && witnesses_ > slot() && w_.r.id != none && (!per_part || w_.r.part == slot());
    if (live && point < a.points) p_ = source[point];
  }

  /// Writes the bounds of this block's warps, or of the parts.
  __device__ void seed(const scan::scan_arguments<Tally>& a) const {
    auto& s = memory_of_block<Tally>().answer;
    const std::uint32_t n = threadIdx.x % each;
    std::uint32_t bound = known_;
    if (p_.valid()) {
      const vec3 origin = a.facts().origin;
      const auto seen = a.answer.around.less(its_point(a), p_.position - origin, origin);
      const real d = scan::distance_of(w_.primitive, scan::moved(a.part()[w_.r.part].part_from_cloud, seen), infinity);
      if (d < infinity) bound = lower_of(bound, ordered(d));
    }
    if constexpr (per_part) {
      for (int step = 1; step < int(each); step *= 2) bound = lower_of(bound, __shfl_xor_sync(all_lanes, bound, step));
      if (n == 0) s.bound[slot()] = bound;
    } else {
      bound = least_of(all_lanes, bound);
      if ((threadIdx.x & 31) == 0) s.seed_of_warp[threadIdx.x / 32] = bound;
    }
  }

  /// Returns the bound of all parts to all threads, after `seed` and a barrier. If each part has its own bound:
  /// `no_bound` if one part has none, else 0.
  static __device__ std::uint32_t found(std::uint32_t parts) {
    auto& s = memory_of_block<Tally>().answer;
    const std::uint32_t lane = threadIdx.x & 31;
    if constexpr (per_part) {
      bool all = true;
      for (std::uint32_t k = lane; k < parts; k += 32) all &= s.bound[k] != no_bound;
      return __all_sync(all_lanes, all) ? 0 : no_bound;
    } else {
      const std::uint32_t bound = least_of(all_lanes, lane < warps ? s.seed_of_warp[lane] : no_bound);
      if (threadIdx.x == 0) s.bound[0] = bound;
      return bound;
    }
  }

 private:
  static constexpr bool per_part = Tally::bound_per_part;
  static constexpr std::uint32_t each = block_threads / (per_part ? scan::most_parts : 32);
  static __device__ std::uint32_t slot() { return threadIdx.x / each; }
  /// The number of this thread's point: the minimum's or a neighbour's.
  __device__ std::uint32_t its_point(const scan::scan_arguments<Tally>& a) const {
    const std::uint32_t n = threadIdx.x % each;
    return key_index(w_.r.key) - a.first + n - (n == 0 ? 0 : each / 2);
  }
  typename Tally::witness_type w_;
  std::uint32_t witnesses_, known_ = no_bound;
  sample p_{{}, drop_reason::not_finite};
};

/// Without a last frame, eight lanes take the most promising of their points down a tree (if every part needs a bound,
/// each eight lanes take another part), or each lane looks its own up in a field. Then all blocks wait a little for one
/// another. Only speed depends on that wait, so it gives up rather than hang.
template <class Tally>
__noinline__ __device__ void seed_cold(scan::quad_points p) {
  using parts = scan::frame_parts<Tally>;
  if (parts::here().head.parts == 0) return;
  constexpr int quad = scan::quad;
  constexpr bool per_part = Tally::bound_per_part;
  const scan::eight_lanes team;
#pragma unroll
  for (int j = 0; j < quad; ++j)
    if ((p.reasons >> 8 * j & 0xff) != 0) p.at[j].x = not_a_number;  // can never be the nearest
  auto& s = parts::here().answer;
  const auto& a = parts::here().head;
  // Compares powers: the squared distance to a ball's centre less its squared radius. This needs no root and is good
  // enough. A thread tests one point against all parts, or all four against few parts: a handful of tests.
  real least_power = infinity;
  vec3 x = p.at[0];
  const std::uint32_t first = per_part ? (threadIdx.x / team.size + blockIdx.x) % a.parts : 0,
                      end = per_part ? first + 1 : a.parts;
  std::uint32_t k_least = first;  // also of lanes without a point, which hear the team's bound
  const auto test = [&](std::uint32_t k, vec3 at) {
    const ball around = parts::place(k).root.around;
    const vec3 d = at - around.center;
    const real power = fma(-around.radius, around.radius, dot(d, d));
    if (power < least_power) {
      least_power = power;
      k_least = k;
      x = at;
    }
  };
  if (end - first < quad) {
    for (std::uint32_t k = first; k < end; ++k)
#pragma unroll
      for (int j = 0; j < quad; ++j) test(k, p.at[j]);
  } else {
    for (std::uint32_t k = first; k < end; ++k) test(k, p.at[0]);
  }
  real d = infinity;
  if (a.answer.fields != nullptr) {
    if (least_power < infinity) d = a.answer.fields[k_least](parts::place(k_least).part_from_cloud(x)).high;
    d = team.least(d);
  } else {
    const real nearest = team.least(least_power);
    const int winner = team.first(least_power < infinity && least_power == nearest);
    k_least = team.from(winner, k_least);
    x = team.from(winner, x);
    d = scan::descend(scan::steps_of_part<Tally>{k_least}, parts::place(k_least).part_from_cloud(x), winner >= 0, team);
  }
  std::uint32_t bound = d < infinity ? ordered(d) : no_bound;
  if constexpr (!per_part) bound = least_of(all_lanes, bound);
  if ((per_part || (threadIdx.x & 31) == 0) && bound != no_bound) atomicMin(&s.bound[Tally::slot(k_least)], bound);
  __syncthreads();
  const std::uint32_t bounds = per_part ? a.parts : 1;
  for (std::uint32_t k = threadIdx.x; k < bounds; k += block_threads) atomicMin(&a.answer.state->bound[k], s.bound[k]);
  __syncthreads();
  if (threadIdx.x == 0) {
    scan::count_in(a.answer.state->seeded);
    constexpr long long patience =
        20000;  // cycles, about 10 us; a block that gives up has a looser bound and the same answer
    const long long start = clock64();
    while (fresh(a.answer.state->seeded) < gridDim.x && clock64() - start < patience) {
    }
  }
  __syncthreads();
  for (std::uint32_t k = threadIdx.x; k < bounds; k += block_threads)
    atomicMin(&s.bound[k], fresh(a.answer.state->bound[k]));
}

}  // namespace clearance::minimum
