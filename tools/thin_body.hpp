// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/certify.hpp>

#include <chrono>

/// Spheres for a body too thin to be packed, such as a plate of nearly no thickness: small ones inside, spread along its surface, with their
/// certificate. None, if none of them fits either.
inline clearance::packing spheres_along(const clearance::mesh_solid& solid, std::size_t count) {
  using clearance::inner_sphere, clearance::real;
  const auto begin = std::chrono::steady_clock::now();
  clearance::packing made;
  for (const Eigen::Vector3d& p : solid.surface_points(count)) {
    inner_sphere best{{0, 0, 0}, 0};
    for (const double in : {1e-6, 1e-7, 1e-8})
      for (int side = 0; side < 6; ++side) {
        const Eigen::Vector3d there = p + in * (side % 2 ? 1 : -1) * Eigen::Vector3d::Unit(side / 2);
        const clearance::vec3 center{real(there.x()), real(there.y()), real(there.z())};
        const Eigen::Vector3d rounded(center.x, center.y, center.z);
        if (const auto radius = real(solid.distance(rounded) * (1 - 1e-6)); radius > best.radius && solid.inside(rounded)) best = {center, radius};
      }
    if (best.radius > 0) made.spheres.push_back(best);
  }
  if (made.spheres.empty()) return made;
  std::ranges::stable_sort(made.spheres, std::greater{}, &inner_sphere::radius);
  made = clearance::io::certify(solid, std::move(made), 0.05).spheres;
  made.radius_max = made.spheres.front().radius, made.radius_min = made.spheres.back().radius;
  made.stopped_by = clearance::pack_stop::no_room;
  made.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return made;
}
