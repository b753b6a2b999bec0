// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How much room there is at a place in a solid, between its surface and the spheres that are there already.

#include <clearance/packing/compass.hpp>
#include <clearance/solid/box_tree.hpp>
#include <clearance/solid/solid.hpp>

namespace clearance {

/// The room that spheres leave in a solid, in double, on host and device: a tree over most spheres, a list of the rest.
template <solid_view V>
struct room_view {
  V solid;
  const solid_sphere* spheres;
  std::uint32_t count;
  box_tree_view tree;  ///< Over the first `tree.items` spheres.

  /// The distance to spheres `first` and later if it is below `within`, else `within`.
  CLEARANCE_HD double gap_from(std::uint32_t first, const vec3d& p, double within) const {
    for_near(first, p, within, [&](const solid_sphere& s) { return within = s.nearer(p, within); });
    return within;
  }
  /// The same for all spheres; stops early at any value of at most `enough`.
  CLEARANCE_HD double gap(const vec3d& p, double within, double enough = -double(infinity)) const {
    within = tree_gap(p, within, enough);
    return within <= enough ? within : gap_from(tree.items, p, within);
  }
  /// The same for eight places side by side, on the host: `within` of each becomes its gap, or at most `enough`.
  void gaps(const eighths& p, eight& within, double enough) const {
    const double most = tree.nearest(p, within.largest_above(enough), [&](std::uint32_t i, double) {
      spheres[i].nearer(p, within);
      return within.largest_above(enough);
    });
    const double away = std::sqrt(3.0) * p.apart * (1 + 1e-9);
    for_near(tree.items, p.middle, most + away, [&](const solid_sphere& s) {
      s.nearer(p, within);
      return within.largest_above(enough) + away;
    });
  }
  /// The distance to surface and spheres, as `gap`.
  CLEARANCE_HD double room(const vec3d& p, double within, double enough = 0) const {
    within = tree_gap(p, within, enough);
    if (within > enough) within = solid.distance(p, within, enough);
    return within <= enough ? within : gap_from(tree.items, p, within);
  }

 private:
  /// Calls `visit(sphere)`, which returns the new reach, for those from `first` on that are nearer to p than `reach`,
  /// and perhaps some others.
  CLEARANCE_CALLS_ANYTHING
  template <class F>
  CLEARANCE_HD void for_near(std::uint32_t first, const vec3d& p, double reach, F visit) const {
#if defined(__CUDA_ARCH__)
    (void)reach;
    for (std::uint32_t i = first; i < count; ++i) visit(spheres[i]);
#else
    for (std::uint32_t i = first, next; i < count; i = next) {  // most are far away, which a host sees for many at once
      next = count - i < 32 ? count : i + 32;
      if (any_near({spheres + i, next - i}, p, reach))
        for (std::uint32_t k = i; k < next; ++k) reach = visit(spheres[k]);
    }
#endif
  }
  CLEARANCE_HD double tree_gap(const vec3d& p, double within, double enough) const {
    return tree.nearest(
        p, within, [this, &p](std::uint32_t i, double best) { return spheres[i].nearer(p, best); }, enough);
  }
};

}  // namespace clearance
