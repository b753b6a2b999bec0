// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From the best records of blocks to the answer: its witness, and what is certain.

#include <clearance/frames/bracket.hpp>
#include <clearance/minimum/resolve.hpp>
#include <clearance/minimum/seeds.cuh>
#include <clearance/scan/drops.hpp>
#include <clearance/scan/pairs.cuh>

namespace clearance::minimum {

// The best candidates that a block has found.

/// Returns the least of a warp's records to all its lanes.
template <class Record>
__device__ Record least_of_warp(const Record& r) {
  using scan::all_lanes;
  unsigned those = all_lanes;
  const auto keep = [&those](std::uint32_t value) {
    const bool in = those >> (threadIdx.x & 31) & 1;
    const std::uint32_t least = scan::least_of(all_lanes, in ? value : none);
    those = __ballot_sync(all_lanes, in && value == least);
  };
  keep(std::uint32_t(r.key >> 32));
  if ((those & (those - 1)) != 0) {
    keep(std::uint32_t(r.key));
    keep(r.part);
    keep(r.id);
  }  // a tie of distances
  const int from = __ffs(int(those)) - 1;
  Record least;
  least.key = __shfl_sync(all_lanes, r.key, from);
  least.part = __shfl_sync(all_lanes, r.part, from);
  least.id = __shfl_sync(all_lanes, r.id, from);
  least.place = scan::from_lane(r.place, from);
  return least;
}

/// Keeps the better of the block's best and `r`. Improvements are rare (a record process), so a lock costs nothing.
template <class Tally>
__device__ void keep_best(typename Tally::block& s, const typename Tally::record& r,
                          const typename Tally::primitive_type& primitive) {
  const std::uint32_t slot = Tally::slot(r.part);
  auto& kept = s.answer.best[slot];
  for (bool offered = false; !offered;) {
    if (atomicCAS(&s.answer.lock[slot], 0u, 1u) != 0) continue;
    __threadfence_block();
    if (before(r, kept)) {
      kept = r;
      if constexpr (!Tally::bound_per_part) s.answer.nearest = primitive;
    }
    __threadfence_block();
    atomicExch(&s.answer.lock[slot], 0u);
    offered = true;
  }
}

/// All lanes of a warp call it. For one minimum the warp agrees on its best first. With one minimum per part, the lanes
/// that share a part agree, and then the block by an atomic minimum. So few lanes reach the lock.
template <class Tally>
__device__ void best_of_warp(typename Tally::block& s, const typename Tally::record& r,
                             const typename Tally::primitive_type& primitive) {
  if constexpr (Tally::bound_per_part) {
    const std::uint32_t mine = std::uint32_t(r.key >> 32);
    const std::uint32_t least = scan::least_of(__match_any_sync(scan::all_lanes, r.part), mine);
    if (r.key == no_key || mine != least || r.key > atomicMin(&s.answer.least[r.part], r.key)) return;
  } else {
    const bool parts_decide = Tally::bounds_differ(s);
    if (parts_decide && r.key != no_key) Tally::lower(s, r.part, key_distance(r.key));
    if (!same(r, least_of_warp(r))) return;
    if (parts_decide && r.key > atomicMin(&s.answer.least[0], r.key)) return;  // it was farther, and decides
  }
  Tally::lower(s, r.part, key_distance(r.key));
  keep_best<Tally>(s, r, primitive);
}

/// The point and the primitive of a record.
template <class Tally>
struct evidence {
  using part_type = typename Tally::part_type;
  using primitive_type = typename Tally::primitive_type;
  using arguments = scan::scan_arguments<Tally>;
  using steps = scan::tree_steps<Tally>;

  typename Tally::record r;
  vec3 p;  ///< In the cloud's frame: the point, or where its capsule starts.
  primitive_type primitive;
  bool inside_solid = false;  ///< The point, or the capsule's start.

  evidence() = default;
  template <class Source>
  __device__ evidence(const arguments& a, const Source& source, const typename Tally::record& of) : r(of) {
    if (r.key == no_key || key_index(r.key) < a.first) return;
    if (r.id != none) primitive = steps::primitive(r.part, r.place);
    inside_solid = r.id == none;
    p = source[key_index(r.key) - a.first].position;
  }
  /// From a witness whose point is in this cloud.
  template <class Source>
  __device__ evidence(const arguments& a, const Source& source, const typename Tally::witness_type& w)
      : r(w.r), p(source[key_index(w.r.key) - a.first].position), primitive(w.primitive) {}

  __device__ auto in_part() const {
    const auto& head = steps::here().head;
    const vec3 origin = steps::here().origin;
    const auto all = head.answer.around.less(key_index(r.key) - head.first, p - origin, origin);
    return scan::moved(steps::place(r.part).part_from_cloud, all);
  }

  /// For a point inside a solid, finds the closest primitive, which the scan has not looked for. Returns true if the
  /// point is below the surface.
  __device__ bool complete() {
    if constexpr (scan::has_interior<part_type>)
      if (r.id == none) {
        nearest_primitive<primitive_type> nearest{infinity};
        scan::walk_for(scan::walk_alone<Tally>{}, steps::view(r.part).tree, in_part(), nearest);
        r.id = nearest.id;
        primitive = nearest.primitive;
        return nearest.within > 0;
      }
    return false;
  }

  /// Which place of a capsule is meant.
  __device__ real share() const { return inside_solid ? 0 : scan::share_near(primitive, in_part()); }
  __device__ position at(const arguments& a) const {
    const vec3 x = scan::place_at(a.answer.around(key_index(r.key) - a.first, p), share());
    return a.placed ? a.rest->frame.world_from_cloud(x) : a.frame.world_from_cloud(x);
  }
  __device__ contact touching(const arguments& a, bool inside) const {
    return contact_of(primitive, scan::place_at(in_part(), share()), inside, a.pose(r.part));
  }

  /// Writes the witness to the result.
  __device__ void write(const arguments& a) {
    const bool inside = complete();
    min_distance_result& out = *a.answer.result;
    out.cloud = a.cloud;
    out.point = key_index(r.key) - a.first;
    out.part = r.part;
    out.primitive = r.id;
    out.at = at(a);
    const contact here = touching(a, inside);
    out.nearest = here.nearest;
    out.normal = here.normal;
  }
};

/// How far the robot is at least: if what is taken of every part's distance is the same;
template <class Tally>
__device__ double certain_of(const scan::scan_arguments<Tally>& a, const typename Tally::record& best) {
  return frames::certain_distance(key_distance(best.key), a.facts().slop, a.facts().error);
}
/// by the block's best of each part;
template <class Tally>
__device__ double certain_of_each(const scan::scan_arguments<Tally>& a) {
  using parts = scan::frame_parts<Tally>;
  return frames::certain_distance(
      a.parts, [](std::uint32_t k) { return key_distance(parts::here().answer.best[k].key); },
      [](std::uint32_t k) -> const part_facts& { return parts::view(k).facts; }, a.facts().error);
}
/// by the parts' own bounds, which are forgotten then. Called by a warp.
template <class Tally>
__device__ double certain_of_parts(const scan::scan_arguments<Tally>& a) {
  using parts = scan::frame_parts<Tally>;
  const std::uint32_t lane = threadIdx.x % 32, its = lane < a.parts ? (a.parts - lane + 31) / 32 : 0;
  double least = frames::certain_distance(
      its,
      [&](std::uint32_t k) {
        std::uint32_t& bound = a.answer.state->bound[1 + lane + 32 * k];
        const std::uint32_t known = scan::fresh(bound);
        bound = no_bound;
        return from_ordered(known);
      },
      [&](std::uint32_t k) -> const part_facts& { return parts::view(lane + 32 * k).facts; }, a.facts().error);
  for (int step = 1; step < 32; step *= 2) least = fmin(least, __shfl_xor_sync(scan::all_lanes, least, step));
  return least;
}

/// The minimum `best` with its bracket, after all clouds. `certain`: some point is certainly inside.
template <class Tally>
__device__ min_distance_result bracket_of(const scan::scan_arguments<Tally>& a, const typename Tally::record& best,
                                          bool certain, double lower) {
  min_distance_result r;
  if (best.key == no_key) return r;
  r.distance = key_distance(best.key);
  r.part = best.part;
  frames::bracket(r, lower, scan::frame_parts<Tally>::view(best.part).facts.tolerance, certain, a.facts().error);
  return r;
}

/// What all blocks have counted. One thread reads all words together, because each read is a round trip to memory.
struct counted {
  unsigned long long dropped[drop_reasons];
  bool certain;  ///< Some point is certainly inside.

  counted() = default;
  template <class Tally>
  explicit __device__ counted(const scan::scan_arguments<Tally>& a) {
    for (int k = 0; k < drop_reasons; ++k) dropped[k] = scan::fresh(a.state->dropped[k]);
    certain = scan::fresh(a.answer.state->certain) != 0;
  }
};

/// Writes bracket and counts to the result, and a blank witness if there is no minimum.
template <class Tally>
__device__ void write_bracket(const scan::scan_arguments<Tally>& a, min_distance_result r, const counted& all) {
  min_distance_result& out = *a.answer.result;
  if (r.part == none) out = r;
  scan::count(r, all.dropped, std::uint64_t(a.first) + a.points);
  frames::allow_for_too_close(r);
  // If a pose on the device is not rigid, nothing is known. This state stops a robot.
  if (!scan::memory_of_block<Tally>().rigid) r.state = clearance::state::possible;
  out.state = r.state;
  out.distance = r.distance;
  out.lower = r.lower;
  out.upper = r.upper;
  out.seen = r.seen;
  out.valid = r.valid;
  for (int k = 0; k < drop_reasons; ++k) out.dropped[k] = r.dropped[k];
}

}  // namespace clearance::minimum
