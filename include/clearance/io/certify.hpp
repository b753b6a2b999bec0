// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Proves what spheres from elsewhere say of a solid.

#include <clearance/packing/gap.hpp>
#include <clearance/packing/packing.hpp>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

namespace clearance::io {

/// Certified: no point of a sphere is farther from the solid than this, metres; 0 if all lie inside. The surface is
/// no nearer to a centre than `distance`: a sphere sticks out by its radius less that, or plus that if centred outside.
template <solid S>
double excess(const S& s, std::span<const inner_sphere> spheres) {
  std::vector<double> out(spheres.size());
  tbb::parallel_for(std::size_t(0), spheres.size(), [&](std::size_t i) {
    const Eigen::Vector3d c(spheres[i].center.x, spheres[i].center.y, spheres[i].center.z);
    const double d = s.distance(c), scale = c.norm() + d + spheres[i].radius;
    out[i] = spheres[i].radius + (s.inside(c) ? -d : d) + 1e-12 * scale;
  });
  double most = 0;
  for (const double e : out) most = std::max(most, e);
  return most;
}

/// Spheres from elsewhere, compared with the mesh that they stand for.
struct certified_spheres {
  packing spheres;    ///< The spheres unchanged, with their gap to this solid.
  double excess = 0;  ///< How far they stick out of it, metres.

  /// For make_part: the distance to the spheres may exceed that to the solid by `gap`, and fall below it by `excess`. A
  /// part's tolerance covers both directions, so the gap is what is missing above it.
  double part_gap() const { return std::max(0.0, spheres.gap - excess); }
};

/// Proves the figures of spheres from a file against this solid: gap, fill, excess.
template <solid S>
certified_spheres certify(const S& s, packing spheres, double gap_tolerance = 0.01) {
  const gap_report gap = measure_gap(s, std::span<const inner_sphere>(spheres.spheres), gap_tolerance);
  spheres.gap = gap.certified;
  spheres.gap_mean = gap.mean;
  spheres.gap_p95 = gap.p95;
  spheres.fill = spheres.tolerance = 0;
  if constexpr (requires { s.tolerance(); }) spheres.tolerance = s.tolerance();
  if constexpr (requires { s.volume(); })
    for (const inner_sphere& ball : spheres.spheres)
      spheres.fill += 4.0 / 3 * std::numbers::pi * std::pow(double(ball.radius), 3) / s.volume();
  const double out = excess(s, std::span<const inner_sphere>(spheres.spheres));
  return {std::move(spheres), out};
}

}  // namespace clearance::io
