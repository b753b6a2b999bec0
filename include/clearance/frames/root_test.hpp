// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// May a point be near a part? Quick tests against the ball around it, which miss nothing.

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

/// May anything in a capsule be within reach of a ball?
CLEARANCE_HD inline bool may_reach(const ball& around, real reach, const capsule& c) {
  return may_reach({{0, 0, 0}, around.radius}, reach + c.radius + detail::noise_along(c),
                   detail::rough_way(c, around.center));
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

/// A way that leads from a place straight away from an eye, however far, with what tests against many balls need. A way
/// that begins so near the eye that its direction is rounding passes every test.
struct sight_test {
  vec3 from, away;
  real square, away_square, along;  ///< |from|^2 less a margin, |away|^2, from * away.

  sight_test() = default;
  /// `from`: the place less the frame's origin.
  CLEARANCE_HD sight_test(vec3 from, vec3 origin)
      : from(from),
        away(from + origin),
        square(dot(from, from) * (1 - margin)),
        away_square(dot(away, away)),
        along(dot(from, away)) {
    if (!(256 * away_square >= dot(origin, origin) && away_square >= least_normal)) {
      away = {0, 0, 0};
      away_square = 0;
      along = from.x == from.x ? -infinity : not_a_number;
    }
  }
  static constexpr real margin = 0x1p-16f;  ///< More than rounding changes in a square, as a share of all squares.
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
  /// Is the way's line that near, and ahead of it, or its start?
  CLEARANCE_HD bool passes(const sight_test& x) const {
    const real start = value(x.from) + x.square - 0.25f * sight_test::margin * dot(m, m);
    const real ahead = -0.5f * dot(m, x.away) - x.along;
    return start <= 0 || (ahead > 0 && start * x.away_square <= ahead * ahead);
  }
  CLEARANCE_HD bool passes(vec3 x) const { return value(x) <= -(x.x * x.x + x.y * x.y + x.z * x.z); }
};

}  // namespace clearance::frames
