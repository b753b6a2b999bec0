// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From the least distance to the whole result: its witness is computed again, then bracket, counts and state.

#include <clearance/frames/bracket.hpp>
#include <clearance/frames/root_test.hpp>
#include <clearance/ground/pose.hpp>
#include <clearance/minimum/shared_bounds.hpp>
#include <clearance/result.hpp>
#include <clearance/scan/drops.hpp>
#include <clearance/scan/element.hpp>
#include <clearance/scan/interior.hpp>

namespace clearance::minimum {

// The witness of a pair: the place on a part that is nearest to a point.

/// The closest primitive itself; of equally close ones the one with the lowest id.
template <primitive P>
struct nearest_primitive {
  using result_type = std::uint32_t;

  real within;
  std::uint32_t id = none;
  P primitive = {};

  CLEARANCE_HD real reach() const { return within; }
  CLEARANCE_HD void offer(std::uint32_t, real) {}
  CLEARANCE_HD void offer(std::uint32_t i, real distance, const P& p) {
    if (distance < within || (distance == within && i < id)) {
      within = distance;
      id = i;
      primitive = p;
    }
  }
  CLEARANCE_HD std::uint32_t result() const { return id; }
};

/// In world coordinates.
struct contact {
  position nearest;
  vec3 normal;
};

/// The contact of a primitive with the point q, in the part's frame. `inside` a solid the normal is reversed: the way
/// out is towards the surface.
template <primitive P>
CLEARANCE_HD contact contact_of(const P& primitive, vec3 q, bool inside, const world_transform& world_from_part) {
  const vec3 away = primitive.normal(q);
  return {world_from_part(primitive.nearest(q)), world_from_part.turned(inside ? -away : away)};
}

/// A point's distance to a part, and the part's nearest primitive.
template <primitive P>
struct nearest_of_part {
  real distance;
  bool inside;
  nearest_primitive<P> nearest;

  CLEARANCE_HD contact at(vec3 q, const world_transform& world_from_part) const {
    return contact_of(nearest.primitive, q, inside && nearest.within > 0, world_from_part);
  }
};

/// The distance of a point or capsule by the scan's rule: 0 inside, else that of the closest primitive, if it is at
/// most `within`.
template <class PartView, class Element, class Traversal>
CLEARANCE_HD auto evaluate(const PartView& part, const Element& q, real within, const Traversal& walk) {
  nearest_of_part<typename PartView::hierarchy_type::primitive_type> f{infinity, false, {within}};
  if constexpr (scan::has_interior<PartView>) {
    f.inside = part.interior.inside(scan::start_of(q));
    if (f.inside) f.nearest.within = infinity;
  }
  scan::walk_for(walk, part.tree, q, f.nearest);
  if (f.nearest.id != none) f.distance = f.inside ? 0 : f.nearest.within;
  return f;
}

/// Recomputes the witness of a key, in fixed order, if its point is in this cloud. Index `part_count` is the robot's
/// minimum; lower indices are the parts' own.
template <class PartView, point_source Source, class Traversal>
struct resolve_body {
  const PartView* parts;
  const frames::placement* places;
  std::uint32_t part_count;
  Source source;
  vec3 origin;
  world_transform world_from_cloud;
  std::uint32_t first, cloud;
  shared_bounds bounds;
  Traversal walk;
  min_distance_result* result;
  part_minimum* minima;

  /// Can the key belong to part `k`? If not, the part need not be searched.
  CLEARANCE_HD bool may_be_of(std::uint32_t k) const {
    const distance_key key = bounds.all->best;
    return mine(key) && frames::may_reach(places[k].around, key_distance(key), element(key_index(key) - first));
  }

  CLEARANCE_HD void operator()(std::size_t i) const {
    if (i < part_count) {
      if (minima != nullptr) own(std::uint32_t(i));
    } else {
      robots();
    }
  }

 private:
  /// Less the origin.
  CLEARANCE_HD auto element(std::uint32_t point) const {
    return scan::element_less(source, point, source[point].position - origin, origin);
  }
  CLEARANCE_HD bool mine(distance_key key) const {
    return key != no_key && key_index(key) >= first && key_index(key) - first < source.size();
  }

  CLEARANCE_HD void own(std::uint32_t k) const {
    const distance_key key = bounds.part_best[k];
    if (!mine(key)) return;
    const std::uint32_t point = key_index(key) - first;
    const auto q = scan::moved(places[k].part_from_cloud, element(point));
    minima[k] = {key_distance(key), cloud, point, evaluate(parts[k], q, key_distance(key), walk).nearest.id};
  }

  CLEARANCE_HD void robots() const {
    distance_key key = bounds.all->best;
    if (bounds.bound_per_part())
      for (std::uint32_t k = 0; k < part_count; ++k) key = bounds.part_best[k] < key ? bounds.part_best[k] : key;
    if (!mine(key)) return;
    const std::uint32_t point = key_index(key) - first;
    const auto p = scan::element_of(source, point, source[point].position);
    for (std::uint32_t k = 0; k < part_count; ++k) {
      const auto q = scan::moved(places[k].part_from_cloud, element(point));
      const auto f = evaluate(parts[k], q, key_distance(key), walk);
      if (f.distance != key_distance(key)) continue;
      const real share = f.inside ? 0 : scan::share_near(f.nearest.primitive, q);
      const contact here = f.at(scan::place_at(q, share), places[k].world_from_part);
      result->distance = f.distance;
      result->cloud = cloud;
      result->point = point;
      result->part = k;
      result->primitive = f.nearest.id;
      result->at = world_from_cloud(scan::place_at(p, share));
      result->nearest = here.nearest;
      result->normal = here.normal;
      return;
    }
  }
};

/// Writes counts, bracket and state after the last cloud, with one thread.
template <class PartView>
struct conclude_body {
  const PartView* parts;
  std::uint32_t part_count;
  const scan::drop_counts* counts;
  shared_bounds bounds;
  frames::float_error error;  ///< The largest of the call.
  double slop;                ///< Of all parts alike, if there are no minima of parts.
  std::uint64_t seen;
  min_distance_result* result;

  CLEARANCE_HD void operator()(std::size_t) const {
    const distance_key* const best = bounds.part_best;
    const double lower = best == nullptr
                             ? frames::certain_distance(result->distance, slop, error)
                             : frames::certain_distance(
                                   part_count, [best](std::uint32_t k) { return key_distance(best[k]); },
                                   [this](std::uint32_t k) -> const part_facts& { return parts[k].facts; }, error);
    scan::count(*result, counts->dropped, seen);
    frames::bracket(*result, lower, result->part == none ? 0 : parts[result->part].facts.tolerance,
                    bounds.all->certain != 0, error);
    frames::allow_for_too_close(*result);
  }
};

}  // namespace clearance::minimum
