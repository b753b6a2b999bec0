// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the answer says of a record: its witness, and what is certain.

#include <clearance/search/conclude.hpp>
#include <clearance/search/resolve.hpp>
#include <clearance/stream/best.cuh>
#include <clearance/traversal/near_first.hpp>

namespace clearance::stream {

/// What a record is about.
template <class PartView, bool Each>
struct evidence {
  using primitive_type = typename PartView::hierarchy_type::primitive_type;
  using parts = frame_parts<PartView, Each>;

  record r;
  vec3 p;  ///< In the cloud's frame.
  primitive_type primitive;

  evidence() = default;
  template <class Source>
  __device__ evidence(const frame_args<PartView>& a, const Source& source, const record& of) : r(of) {
    if (r.key == no_key || key_index(r.key) < a.first) return;
    if (r.primitive != none) primitive = far(parts::view(r.part).tree.primitives + r.primitive);
    p = source[key_index(r.key) - a.first].position;
  }
  /// Of a record of this cloud.
  template <class Source>
  __device__ evidence(const frame_args<PartView>& a, const Source& source, const witness_of<PartView>& w)
      : r(w.r), p(source[key_index(w.r.key) - a.first].position), primitive(w.primitive) {}

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

  __device__ position at(const frame_args<PartView>& a) const {
    return a.placed ? a.rest->frame.world_from_cloud(p) : a.frame.world_from_cloud(p);
  }
  /// Of a primitive `way_out` of the solid, or with the point outside.
  __device__ void nearest(const frame_args<PartView>& a, real way_out, position& there, vec3& normal) const {
    const world_transform world = a.far ? a.rest->world_from_part[r.part] : a.world_from_part[r.part];
    const vec3 q = in_part(), away = primitive.normal(q);
    there = world(primitive.nearest(q));
    normal = world.turned(way_out > 0 ? -away : away);
  }

  /// All of it to the result.
  __device__ void write(const frame_args<PartView>& a) {
    const real way_out = complete();
    min_distance_result& out = *a.result;
    out.cloud = a.cloud, out.point = key_index(r.key) - a.first, out.part = r.part, out.primitive = r.id;
    out.at = at(a);
    nearest(a, way_out, out.nearest, out.normal);
  }
};

/// The minimum `best` and what is certain of it, if nothing is inside for `certain`; once all clouds are done.
template <class PartView, bool Each>
__device__ min_distance_result bracket(const frame_args<PartView>& a, const record& best, bool certain) {
  using parts = frame_parts<PartView, Each>;
  const auto& s = parts::here();
  const search::frame_facts& frame = a.facts();
  min_distance_result r;
  if (best.key == no_key) return r;
  r.distance = key_distance(best.key), r.part = best.part;
  double lower = search::certain_distance(r.distance, frame.slop, frame.error);
  if constexpr (Each) {
    lower = infinity;
    for (std::uint32_t k = 0; k < a.parts; ++k) {
      const double its = search::certain_distance(key_distance(s.best[k].key), search::slop(parts::view(k).facts), frame.error);
      lower = its < lower ? its : lower;
    }
  }
  search::bracket(r, lower, parts::view(best.part).facts.tolerance, certain, frame.error);
  return r;
}

/// That and the counts to the result; and a blank witness if there is no minimum.
template <class PartView, bool Each>
__device__ void write_bracket(const frame_args<PartView>& a, min_distance_result r, const search::totals& all) {
  min_distance_result& out = *a.result;
  if (r.part == none) out = r;
  search::count(r, all, std::uint64_t(a.first) + a.points);
  // Nothing is known where a pose on the device is none: this stops a robot.
  if (!memory_of_block<PartView, Each>().rigid) r.state = state::possible;
  out.state = r.state, out.distance = r.distance, out.lower = r.lower, out.upper = r.upper, out.seen = r.seen, out.valid = r.valid;
  for (int k = 0; k < drop_reasons; ++k) out.dropped[k] = r.dropped[k];
}

/// What all blocks have counted.
__device__ inline search::totals totals_of(const frame_state& state) {
  search::totals all;
  for (int k = 0; k < drop_reasons; ++k) all.dropped[k] = fresh(state.dropped[k]);
  all.certain = fresh(state.certain);
  return all;
}

}  // namespace clearance::stream
