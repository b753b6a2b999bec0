// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/concepts/capsule.hpp>

namespace clearance::frames {

/// The largest distance of a point within reach from the middle of a part's ball, and more than rounding can add.
CLEARANCE_HD inline real limit(const ball& around, real reach) { return (reach + around.radius) * (1 + 4 * slack); }

/// May a point be within reach of a ball? Cheap and conservative, from differences, for few points. NaN fails.
CLEARANCE_HD inline bool may_reach(const ball& around, real reach, vec3 p) {
  const vec3 d = p - around.center;
  const real most = limit(around, reach);
  return most >= 0 && d.x * d.x + d.y * d.y + d.z * d.z <= most * most;
}

/// The same for anything in a capsule.
CLEARANCE_HD inline bool may_reach(const ball& around, real reach, const capsule& c) {
  return may_reach(around, reach + c.radius + detail::noise_along(c),
                   c.at(clearance::least_along(around.center, c.from, c.along)));
}

/// A ball, with what a test against it needs for any reach.
struct root_ball {
  ball around;
  real square, twice;  ///< |c|^2 and 2 |c|.

  root_ball() = default;
  CLEARANCE_HD explicit root_ball(const ball& b)
      : around(b), square(dot(b.center, b.center)), twice(2 * length(b.center)) {}
};

/// A capsule, with what tests against many balls need.
struct capsule_test {
  vec3 from, along;
  real inverse, wide;  ///< 1 / |along|^2; the radius, and more than rounding can add.

  capsule_test() = default;
  CLEARANCE_HD explicit capsule_test(const capsule& c)
      : from(c.from), along(c.along), inverse(0), wide(c.radius + detail::noise_along(c)) {
    if (const real square = dot(along, along); square > least_normal) inverse = rough_inverse(square);
  }
};

/// Cheap and conservative: may a point x be within reach of a part's ball? If `value(x) <= -|x|^2`, it may, in the
/// cloud's own frame, with three multiply-adds. This is not part of the exact path, so compilers may contract it.
struct alignas(16) root_test {
  vec3 m;  ///< -2 c
  real w;  ///< |c|^2 - limit^2, less what rounding can add; rises as the reach falls.

  root_test() = default;
  CLEARANCE_HD root_test(const root_ball& r, real limit) {
    const real sum = r.twice + limit;
    const real margin = 0x1p-20f * (sum * sum + limit * limit);
    m = {-2 * r.around.center.x, -2 * r.around.center.y, -2 * r.around.center.z};
    w = limit >= 0 ? r.square - (limit * limit + margin) : infinity;
  }
  CLEARANCE_HD root_test(const ball& around, real reach) : root_test(root_ball(around), limit(around, reach)) {}

  CLEARANCE_HD real value(real x, real y, real z) const { return m.x * x + (m.y * y + (m.z * z + w)); }
  CLEARANCE_HD real value(vec3 x) const { return value(x.x, x.y, x.z); }
  /// Is anything of a capsule? The squared limit is |c|^2 - w.
  CLEARANCE_HD bool passes(const capsule_test& x) const {
    const vec3 c{m.x * -0.5f, m.y * -0.5f, m.z * -0.5f}, way = c - x.from;
    const real share = saturated((way.x * x.along.x + way.y * x.along.y + way.z * x.along.z) * x.inverse);
    const real dx = way.x - share * x.along.x, dy = way.y - share * x.along.y, dz = way.z - share * x.along.z;
    const real limit = rough_root(c.x * c.x + c.y * c.y + c.z * c.z - w) + x.wide;  // NaN if nothing is within reach
    return dx * dx + dy * dy + dz * dz <= limit * limit;
  }
  CLEARANCE_HD bool passes(vec3 x) const { return value(x) <= -(x.x * x.x + x.y * x.y + x.z * x.z); }
};

}  // namespace clearance::frames
