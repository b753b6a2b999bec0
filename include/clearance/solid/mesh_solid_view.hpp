// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/box_tree_view.hpp>
#include <clearance/solid/exact_triangle.hpp>
#include <clearance/solid/winding_view.hpp>

namespace clearance {

/// Searches in a mesh solid, on host and device.
struct mesh_solid_view {
  box_tree_view tree;
  const exact_triangle* triangles;
  basic_winding_view<double> winding;

  /// The distance to the surface if it is below `within`, else `within`. Stops early at any upper bound of at most
  /// `enough`.
  CLEARANCE_HD double distance(const vec3d& p, double within, double enough = 0) const {
    return tree.nearest(
        p, within, [this, &p](std::uint32_t i, double best) { return triangles[i].nearer(p, best); }, enough);
  }
  CLEARANCE_HD bool inside(const vec3d& p) const { return winding.inside(p.x, p.y, p.z); }

  /// Calls take(i) for each triangle that is closer to p than `reach`.
  CLEARANCE_CALLS_ANYTHING
  template <class F>
  CLEARANCE_HD void near(const vec3d& p, double reach, F take) const {
    tree.nearest(p, reach, [&](std::uint32_t i, double best) {
      if (triangles[i].nearer(p, best) < best) take(i);
      return best;
    });
  }
  CLEARANCE_HD double nearer(std::uint32_t i, const vec3d& p, double best) const {
    return triangles[i].nearer(p, best);
  }
};

}  // namespace clearance
