// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Boxes along the axes as the volumes of a tree.

#include <clearance/concepts.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace clearance {

/// Axis-aligned box.
struct aabb {
  vec3 lower, upper;

  /// Exact in double, then widened by `slack` of the diagonal and rounded outward.
  static aabb fit(std::span<const ball> balls) {
    double lo[3] = {infinity, infinity, infinity}, hi[3] = {-infinity, -infinity, -infinity};
    for (const ball& b : balls) {
      const double c[3] = {b.center.x, b.center.y, b.center.z};
      for (int k = 0; k < 3; ++k) {
        lo[k] = std::min(lo[k], c[k] - b.radius);
        hi[k] = std::max(hi[k], c[k] + b.radius);
      }
    }
    const double margin = 2.0 * slack * std::hypot(hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]) + vanishing;
    const auto down = [&](double x) { return std::nextafter(real(x - margin), -infinity); };
    const auto up = [&](double x) { return std::nextafter(real(x + margin), infinity); };
    return {{down(lo[0]), down(lo[1]), down(lo[2])}, {up(hi[0]), up(hi[1]), up(hi[2])}};
  }

  /// Outside: the distance to the box. Inside: minus the distance to the nearest face, or deep points would be pruned.
  CLEARANCE_HD real lower_bound(vec3 q) const {
    const vec3 beyond{rough_max(lower.x - q.x, q.x - upper.x), rough_max(lower.y - q.y, q.y - upper.y),
                      rough_max(lower.z - q.z, q.z - upper.z)};
    const real deepest = rough_max(rough_max(beyond.x, beyond.y), beyond.z);
    const real outside = rough_length({rough_max(beyond.x, 0), rough_max(beyond.y, 0), rough_max(beyond.z, 0)});
    return rough_min(deepest, 0) * (1 + slack) + outside * (1 - slack);  // one of the two is 0; so there is no branch
  }

  /// Outside along the way from the box. Inside along the axis of the nearest face.
  CLEARANCE_HD tangent tangent_at(vec3 q) const {
    const vec3 below = lower - q, above = q - upper;
    const box_sides sides{
        {rough_max(below.x, above.x), rough_max(below.y, above.y), rough_max(below.z, above.z)},
        {choice(above.x < below.x, -1, 1), choice(above.y < below.y, -1, 1), choice(above.z < below.z, -1, 1)}};
    return sides.tangent_of_box();
  }

  /// Outside it measures from the box. Inside it is true for any reach but minus infinity.
  CLEARANCE_HD bool may_reach(vec3 q, real reach) const {
    const vec3 beyond{positive_part(max(lower.x - q.x, q.x - upper.x)),
                      positive_part(max(lower.y - q.y, q.y - upper.y)),
                      positive_part(max(lower.z - q.z, q.z - upper.z))};
    return beyond.x * beyond.x + beyond.y * beyond.y + beyond.z * beyond.z <= square_of_reach(reach);
  }

  std::array<ball, 8> balls() const {
    std::array<ball, 8> corners;
    for (int k = 0; k < 8; ++k)
      corners[k] = {{k & 1 ? upper.x : lower.x, k & 2 ? upper.y : lower.y, k & 4 ? upper.z : lower.z}, 0};
    return corners;
  }
};

static_assert(bounding_volume<aabb>);

}  // namespace clearance
