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
  /// Is anything of a capsule? The limit is |c|^2 - w.
  CLEARANCE_HD bool passes(const capsule& x) const {
    const vec3 c{-m.x / 2, -m.y / 2, -m.z / 2};
    const real gap = rough_length(x.at(clearance::least_along(c, x.from, x.along)) - c),
               away = rough_max(gap - x.radius - detail::noise_along(x), 0);
    return away * away <= dot(c, c) - w;
  }
  CLEARANCE_HD bool passes(vec3 x) const { return value(x) <= -(x.x * x.x + x.y * x.y + x.z * x.z); }
};

}  // namespace clearance::frames
