// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Spheres as the volumes of a tree.

#include <clearance/concepts.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace clearance {

/// Bounding sphere.
struct sphere {
  vec3 center;
  real radius;

  /// Moves the centre towards the farthest ball by ever smaller steps (Badoiu & Clarkson 2003), in double. Any centre
  /// is valid: the proof needs only the radius, which is then measured and rounded up.
  static sphere fit(std::span<const ball> balls) {
    double c[3] = {0, 0, 0};
    for (const ball& b : balls) {
      c[0] += b.center.x / double(balls.size());
      c[1] += b.center.y / double(balls.size());
      c[2] += b.center.z / double(balls.size());
    }
    const auto away = [&](const ball& b) {
      const double d[3] = {b.center.x - c[0], b.center.y - c[1], b.center.z - c[2]};
      return std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    };
    const auto reach = [&](const ball& b) { return away(b) + b.radius; };

    const int steps = balls.size() > 1 ? 128 : 0;
    for (int k = 1; k <= steps; ++k) {
      const ball* farthest = &balls[0];
      double most = reach(*farthest);
      for (const ball& b : balls)
        if (const double r = reach(b); r > most) {
          farthest = &b;
          most = r;
        }
      if (!(most > 0)) break;

      // A step towards the far side of that ball: the one that would centre it, damped.
      const double along = away(*farthest);
      if (!(along > 0)) break;
      const double step = std::min(1.0, most / (along * (k + 1)));
      c[0] += step * (farthest->center.x - c[0]);
      c[1] += step * (farthest->center.y - c[1]);
      c[2] += step * (farthest->center.z - c[2]);
    }

    const vec3 center{to_float(c[0]), to_float(c[1]), to_float(c[2])};
    c[0] = center.x;
    c[1] = center.y;
    c[2] = center.z;
    double radius = 0;
    for (const ball& b : balls) radius = std::max(radius, reach(b));
    return {center, std::nextafter(real(radius * (1 + 2.0 * slack) + vanishing), infinity)};
  }

  CLEARANCE_HD real lower_bound(vec3 q) const { return fma(rough_length(q - center), 1 - slack, -radius); }

  CLEARANCE_HD tangent tangent_at(vec3 q) const {
    const unit_way way(q - center);
    return {fma(way.length, 1 - slack, -radius), way.direction};
  }

  CLEARANCE_HD bool may_reach(vec3 q, real reach) const {
    const vec3 d = q - center;
    const real most = (reach + radius) * (1 + 4 * slack);
    return bool(int(most >= 0) & int(d.x * d.x + d.y * d.y + d.z * d.z <= most * most));
  }

  CLEARANCE_HD ball as_ball() const { return {center, radius}; }
  std::array<ball, 1> balls() const { return {{as_ball()}}; }
};

static_assert(round_volume<sphere>);

}  // namespace clearance
