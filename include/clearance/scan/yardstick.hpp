// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What must be looked at for points that lie together, seen from their middle. Some primitive, the yardstick, is known
// to be near. Its distance from each point is below one linear function of the way from the middle; that of anything
// else is above another one. What is above for every point of the box cannot be nearest to any.

#include <clearance/concepts/tangent.hpp>

namespace clearance::scan {

/// How far the nearest known primitive is at most from points around a middle.
struct alignas(16) yardstick {
  vec3 direction{0, 0, 0};
  real most = infinity;  ///< In the middle, such that distances are below most + dot(direction, e).

  yardstick() = default;
  /// `way`: the tangent's direction in the points' frame; `radius`: of a ball around the points.
  CLEARANCE_HD yardstick(const primitive_tangent& t, vec3 way, real radius) {
    // Near the primitive its tangent bends too much; then all points are within a radius.
    const bool straight = t.radius > radius;
    direction = choice(straight, way, vec3{0, 0, 0});
    most = t.most + choice(straight, radius * radius * 0.50001f * rough_inverse(t.radius), radius);
  }

  /// Raises it until it is 0 or more all over a box: a point inside a solid is 0 away, whatever its primitives say.
  CLEARANCE_HD void raise_to_zero(vec3 half) {
    const vec3 u = direction;
    const real least = most - (absolute(u.x) * half.x + absolute(u.y) * half.y + absolute(u.z) * half.z);
    if (least < 0) most -= least;
  }
};

/// Points in a box, and what is known of them.
struct alignas(16) surroundings {
  vec3 middle;
  real limit = infinity;  ///< How far from the middle something may be that matters to any point.
  vec3 half;              ///< Half the box, axis by axis.
  real noise;  ///< More than the rounding of two transforms of a point, and of products with ways from the middle.
  yardstick best;
  real within = infinity;  ///< No point is farther from the yardstick.
  real radius;             ///< Radius of a ball around the points, from the middle.

  /// `reach`: the largest of the points'.
  CLEARANCE_HD void set_limit(real reach) { limit = min(within, reach) + radius + noise; }
  /// May something that is this near to the middle be nearest to a point of the box?
  CLEARANCE_HD bool keeps(real distance, vec3 way) const {
    const real beside = absolute(best.direction.x - way.x) * half.x + absolute(best.direction.y - way.y) * half.y +
                        absolute(best.direction.z - way.z) * half.z;
    return bool(int(distance <= limit) & int(distance - best.most <= beside + noise));
  }
  /// May something be so near to the point at middle + e? `distance` and `way` are those of its tangent.
  CLEARANCE_HD bool may_reach(real distance, vec3 way, vec3 e, real reach) const {
    return distance + dot(way, e) - noise <= reach;
  }
};

/// A part as seen from the middle of points.
struct seen_part {
  real distance;  ///< Everything of the part is at least this far away.
  real noise;     ///< What the part adds to the noise of the surroundings.

  /// `around`: a ball around the part; `q`: the middle in the part's frame.
  CLEARANCE_HD seen_part(const surroundings& points, const ball& around, vec3 q) {
    const real gap = rough_length(points.middle - around.center), size = around.radius + gap + rough_length(q);
    distance = lowered(gap - around.radius, size);
    noise = 2 * slack * (rough_length(points.middle) + size + 2 * points.radius);
  }
};

/// A direction of a part's frame in the cloud's.
CLEARANCE_HD inline vec3 to_cloud(const rigid_transform& part_from_cloud, vec3 u) {
  const auto& row = part_from_cloud.row;
  return fma(u.x, row[0], fma(u.y, row[1], scaled(u.z, row[2])));
}

}  // namespace clearance::scan
