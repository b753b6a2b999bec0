// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From a record to the answer: its witness, and what is certain.

#include <clearance/frame/bracket.hpp>
#include <clearance/minimum/best.cuh>
#include <clearance/minimum/witness.hpp>
#include <clearance/scan/drops.hpp>

namespace clearance::minimum {

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
        r.id = nearest.id, primitive = nearest.primitive;
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
    out.cloud = a.cloud, out.point = key_index(r.key) - a.first, out.part = r.part, out.primitive = r.id;
    out.at = at(a);
    const contact here = touching(a, inside);
    out.nearest = here.nearest, out.normal = here.normal;
  }
};

/// The minimum `best` with its bracket, after all clouds. `certain`: some point is certainly inside.
template <class Tally>
__device__ min_distance_result bracket_of(const scan::scan_arguments<Tally>& a, const typename Tally::record& best,
                                          bool certain) {
  using parts = scan::frame_parts<Tally>;
  const auto& s = parts::here().answer;
  const frames::frame_facts& frame = a.facts();
  min_distance_result r;
  if (best.key == no_key) return r;
  r.distance = key_distance(best.key), r.part = best.part;
  double lower;
  if constexpr (Tally::bound_per_part)
    lower = certain_distance(
        a.parts, [&](std::uint32_t k) { return key_distance(s.best[k].key); },
        [](std::uint32_t k) -> const part_facts& { return parts::view(k).facts; }, frame.error);
  else
    lower = certain_distance(r.distance, frame.slop, frame.error);
  bracket(r, lower, parts::view(best.part).facts.tolerance, certain, frame.error);
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
  allow_for_too_close(r);
  // If a pose on the device is not rigid, nothing is known. This state stops a robot.
  if (!scan::memory_of_block<Tally>().rigid) r.state = clearance::state::possible;
  out.state = r.state, out.distance = r.distance, out.lower = r.lower, out.upper = r.upper, out.seen = r.seen,
  out.valid = r.valid;
  for (int k = 0; k < drop_reasons; ++k) out.dropped[k] = r.dropped[k];
}

}  // namespace clearance::minimum
