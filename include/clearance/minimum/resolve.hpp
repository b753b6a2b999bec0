// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/frame/bracket.hpp>
#include <clearance/frame/root_test.hpp>
#include <clearance/minimum/shared_bounds.hpp>
#include <clearance/minimum/witness.hpp>
#include <clearance/scan/drops.hpp>

namespace clearance::minimum {

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
  std::size_t stack_bytes = 0;

  std::size_t device_stack() const
    requires recursing_traversal<Traversal>
  {
    return stack_bytes;
  }

  /// Can the key belong to part `k`? If not, the part need not be searched.
  CLEARANCE_HD bool may_be_of(std::uint32_t k) const {
    const distance_key key = bounds.all->best;
    return mine(key) && frames::may_reach(places[k].around, key_distance(key), element(key_index(key) - first));
  }

  CLEARANCE_HD void operator()(std::size_t i) const {
    if (i < part_count) {
      if (bounds.part_best != nullptr) own(std::uint32_t(i));
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
    if (bounds.part_best != nullptr)
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
      result->cloud = cloud, result->point = point, result->part = k, result->primitive = f.nearest.id;
      result->at = world_from_cloud(scan::place_at(p, share)), result->nearest = here.nearest,
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
  double largest_slop;        ///< Over all parts, because a part without its own minimum has nothing tighter.
  std::uint64_t seen;
  min_distance_result* result;

  CLEARANCE_HD void operator()(std::size_t) const {
    const distance_key* const best = bounds.part_best;
    const double lower = best == nullptr
                             ? certain_distance(result->distance, largest_slop, error)
                             : certain_distance(
                                   part_count, [best](std::uint32_t k) { return key_distance(best[k]); },
                                   [this](std::uint32_t k) -> const part_facts& { return parts[k].facts; }, error);
    scan::count(*result, counts->dropped, seen);
    bracket(*result, lower, result->part == none ? 0 : parts[result->part].facts.tolerance, bounds.all->certain != 0,
            error);
    allow_for_too_close(*result);
  }
};

}  // namespace clearance::minimum
