// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Half-spaces as bounds. The distance to something convex is at least that to any half-space that contains it. So one
// look from the middle of many points tells for each of them how near it can be, by one product.

#include <clearance/ground/math.hpp>

namespace clearance {

/// How near something can be to points around q.
///
/// Law: its computed distance from q + e is at least distance + dot(direction, e) - slack * |e|, for every e.
/// `direction` is about one long, or 0.
struct tangent {
  real distance;
  vec3 direction;
};

/// The same of one primitive, and how far it can be.
///
/// Law: its computed distance from q + e is at most most + dot(direction, e) + |e|^2 / (2 radius) + slack * |e|, and
/// at most most + |e|. A radius of 0 says that only the latter is known.
struct primitive_tangent : tangent {
  real most;
  real radius;
};

/// The place of a primitive's core that is nearest to a point. The core is convex; the primitive is what is within
/// `radius` of it: a sphere is that of its centre, a triangle its own, with no radius.
///
/// Law: the primitive's distance from q is the way from q to `at`, less `radius`, which is the same for every q.
struct core_place {
  vec3 at;
  real radius;
};

/// A vector's length and direction, roughly. The direction is 0 if the length is below 1e-18.
struct unit_way {
  real length;
  vec3 direction;

  CLEARANCE_HD explicit unit_way(vec3 way) : length(looped_root(dot(way, way))) {
    const bool any = length > 1e-18f;
    length = choice(any, length, 0);
    direction = scaled(choice(any, rough_inverse(choice(any, length, 1)), 0), way);
  }
};

/// A point as a box sees it, along the box's three axes.
struct box_sides {
  vec3 beyond;  ///< How far it lies beyond the faces, negative inside,
  vec3 side;    ///< and beyond which of the two: 1 or -1.

  /// Along the way from the box; inside along the axis of the nearest face. Any half-space would be right.
  CLEARANCE_HD tangent tangent_of_box() const {
    const unit_way way({rough_positive(beyond.x), rough_positive(beyond.y), rough_positive(beyond.z)});
    const real deepest = rough_max(rough_max(beyond.x, beyond.y), beyond.z);
    const bool out = way.length > 0, x = beyond.x == deepest, y = bool(int(!x) & int(beyond.y == deepest));
    const vec3 in{choice(x, 1, 0), choice(y, 1, 0), choice(bool(int(x) | int(y)), 0, 1)};
    const vec3 u = choice(out, way.direction, in);
    const real d = choice(out, way.length, deepest);
    return {d - 2 * slack * absolute(d), {u.x * side.x, u.y * side.y, u.z * side.z}};
  }
};

}  // namespace clearance
