// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/result.hpp>
#include <clearance/search/frame.hpp>

namespace clearance::search {

/// The closest primitive itself, of equally close ones that with the lowest id.
template <primitive P>
struct nearest_primitive {
  using result_type = std::uint32_t;

  real within;
  std::uint32_t id = none;
  P primitive = {};

  CLEARANCE_HD real reach() const { return within; }
  CLEARANCE_HD void offer(std::uint32_t, real) {}
  CLEARANCE_HD void offer(std::uint32_t i, real distance, const P& p) {
    if (distance < within || (distance == within && i < id)) within = distance, id = i, primitive = p;
  }
  CLEARANCE_HD std::uint32_t result() const { return id; }
};

/// Recomputes the witness of a key, in fixed order, if its point is one of this cloud's. Index `part_count` is the
/// robot's, the ones below are the parts' own.
template <class PartView, point_source Source, class Traversal>
struct resolve_body {
  const PartView* parts;
  const placement* places;
  std::uint32_t part_count;
  Source source;
  vec3 origin;
  world_transform world_from_cloud;
  std::uint32_t first, cloud;
  const totals* all;
  const distance_key* part_best;
  Traversal walk;
  min_distance_result* result;
  part_minimum* minima;
  std::size_t stack_bytes = 0;

  std::size_t device_stack() const
    requires requires { Traversal::device_stack(1); }
  {
    return stack_bytes;
  }

  CLEARANCE_HD void operator()(std::size_t i) const {
    if (i < part_count) {
      if (part_best != nullptr) own(std::uint32_t(i));
    } else {
      robots();
    }
  }

 private:
  CLEARANCE_HD bool mine(distance_key key) const {
    return key != no_key && key_index(key) >= first && key_index(key) - first < source.size();
  }
  struct found {
    real distance;
    bool inside;
    nearest_primitive<typename PartView::hierarchy_type::primitive_type> nearest;
  };
  /// By the rule of the main loop: 0 inside, else the distance to the closest primitive, if that is not above `within`.
  CLEARANCE_HD found evaluate(std::uint32_t k, vec3 q, real within) const {
    found f{infinity, false, {within}};
    using interior = typename PartView::interior_type;
    if constexpr (!requires { interior::empty; }) {
      f.inside = parts[k].interior.inside(q);
      if (f.inside) f.nearest.within = infinity;
    }
    walk(parts[k].tree, q, f.nearest);
    if (f.nearest.id != none) f.distance = f.inside ? 0 : f.nearest.within;
    return f;
  }

  CLEARANCE_HD void own(std::uint32_t k) const {
    const distance_key key = part_best[k];
    if (!mine(key)) return;
    const std::uint32_t point = key_index(key) - first;
    const vec3 q = places[k].part_from_cloud(source[point].position - origin);
    minima[k] = {key_distance(key), cloud, point, evaluate(k, q, key_distance(key)).nearest.id};
  }

  CLEARANCE_HD void robots() const {
    distance_key key = all->best;
    if (part_best != nullptr)
      for (std::uint32_t k = 0; k < part_count; ++k) key = part_best[k] < key ? part_best[k] : key;
    if (!mine(key)) return;
    const std::uint32_t point = key_index(key) - first;
    const vec3 p = source[point].position;
    for (std::uint32_t k = 0; k < part_count; ++k) {
      const vec3 q = places[k].part_from_cloud(p - origin);
      const found f = evaluate(k, q, key_distance(key));
      if (f.distance != key_distance(key)) continue;
      const auto& primitive = f.nearest.primitive;
      const vec3 away = primitive.normal(q);
      const world_transform& world = places[k].world_from_part;
      result->distance = f.distance;
      result->cloud = cloud, result->point = point, result->part = k, result->primitive = f.nearest.id;
      result->at = world_from_cloud(p);
      result->nearest = world(primitive.nearest(q));
      // From inside a solid the way out is towards the surface.
      result->normal = world.turned(f.inside && f.nearest.within > 0 ? -away : away);
      return;
    }
  }
};

}  // namespace clearance::search
