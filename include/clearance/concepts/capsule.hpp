// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A point may stand for more than itself: for all that it hides, for all places where it may be, or for a ball that is
// full. Each is a swept ball, a capsule. How near one is to a volume and to a primitive.

#include <clearance/concepts/traversal.hpp>
#include <clearance/point_source.hpp>

namespace clearance {

/// A ball that is swept along a straight way. Metres.
struct capsule {
  vec3 from, along;
  real radius;

  CLEARANCE_HD vec3 at(real t) const { return fma(t, along, from); }
};

/// A source whose points are somewhere in their capsules: nothing is certainly anywhere.
template <class S>
concept vague_source = capsule_source<S> && S::vague;

/// A source whose capsules have no length: balls around its points. If it is not vague, all of each ball is there.
template <class S>
concept ball_source = capsule_source<S> && S::balls;

/// A source whose capsules have no width and lead straight away from its (0,0,0), as far as they lead anywhere.
template <class S>
concept sight_source = capsule_source<S> && S::sight;

#define CLEARANCE_STANDS_FOR_MORE                                                                      \
  "the points of this source stand for more (what they hide, where they may be, how large they are): " \
  "questions about pairs and the least distance take such sources, many configurations only balls; this does not"

/// For whatever looks at points alone.
template <point_source S>
consteval bool points_alone() {
  static_assert(!capsule_source<S>, CLEARANCE_STANDS_FOR_MORE);
  return true;
}
/// For whatever takes points and balls.
template <point_source S>
consteval bool points_or_balls() {
  if constexpr (ball_source<S>)
    return true;
  else
    return points_alone<S>();
}

/// A primitive that can be compared with a straight way.
/// Law: of all places from + t along, 0 <= t <= 1, the one at t = `p.least_along(from, along)` has the least
/// `p.distance`, up to rounding. That distance is no greater than that of both ends.
template <class P>
concept swept_primitive = primitive<P> && requires(const P p, vec3 q) {
  { p.least_along(q, q) } -> std::same_as<real>;
};

/// The place of the way that is nearest to a point: between 0 and 1.
CLEARANCE_HD inline real least_along(vec3 point, vec3 from, vec3 along) {
  const real square = dot(along, along);
  return square > 0 ? clamp01(divide(dot(point - from, along), square)) : 0;
}

namespace detail {

/// No less than its length.
CLEARANCE_HD inline real size_of(vec3 v) { return absolute(v.x) + absolute(v.y) + absolute(v.z); }

/// More than rounding adds to a bound along a way, and loses where the radius is added to a reach.
CLEARANCE_HD inline real noise_along(const capsule& c) {
  return 2 * slack * (size_of(c.from) + size_of(c.along) + c.radius);
}

/// From the place of the way that is roughly nearest to a point.
CLEARANCE_HD inline vec3 rough_way(const capsule& c, vec3 to) {
  const vec3 way = to - c.from;
  const real square = dot(c.along, c.along);
  const real t = square > least_normal ? saturated(dot(way, c.along) * rough_inverse(square)) : 0;
  return fma(-t, c.along, way);
}
CLEARANCE_HD inline real bound_along(const ball& b, const capsule& c) {
  return rough_length(rough_way(c, b.center)) * (1 - 2 * slack) - b.radius - noise_along(c);
}

/// By tangents. Each is a line below the distance along the way, which is convex. So the least is where a falling and a
/// rising line meet, or above; there the next tangent is laid, until the bound is above `reach` or hardly rises.
template <tangent_volume V>
CLEARANCE_HD real bound_along(const V& v, const capsule& c, real reach) {
  struct line {
    real t, value, slope;
    CLEARANCE_HD line(const V& v, const capsule& c, real t) : t(t) {
      const tangent its = bounding_volume_traits<V>::tangent_at(v, c.at(t));
      value = its.distance;
      slope = dot(its.direction, c.along);
    }
  };
  const real noise = noise_along(c);
  line falling(v, c, 0);
  if (!(falling.slope < 0)) return falling.value - noise;
  line rising(v, c, 1);
  if (!(rising.slope > 0)) return rising.value - noise;
  for (int k = 0;; ++k) {
    const real meet = divide(rising.value - falling.value + falling.slope * falling.t - rising.slope * rising.t,
                             falling.slope - rising.slope);
    const real t = min(max(meet, falling.t), rising.t);
    const real least =
        min(falling.value + falling.slope * (t - falling.t), rising.value + rising.slope * (t - rising.t));
    if (!(least - noise <= reach) || k == 3) return least - noise;
    const line next(v, c, t);
    (next.slope < 0 ? falling : rising) = next;
  }
}

}  // namespace detail

/// How near anything in a volume can be to a capsule, for prunings beyond `reach`: exact enough for volumes that are
/// balls or have tangents; else by a ball around the volume's balls; else nothing is known.
template <bounding_volume V>
CLEARANCE_HD real lower_bound(const V& v, const capsule& c, real reach) {
  using traits = bounding_volume_traits<V>;
  // distance_to() calls 0 what is within rounding, so a bound on it is lower by that, without a way too.
  if (c.along == vec3{0, 0, 0}) return traits::lower_bound(v, c.from) - detail::noise_along(c) - c.radius;
  if constexpr (round_volume<V>)
    return detail::bound_along(traits::as_ball(v), c) - c.radius;
  else if constexpr (tangent_volume<V>)
    return detail::bound_along(v, c, reach + c.radius) - c.radius;
  else
    return -infinity;
}

/// May a primitive be so near? Quickly, by a ball around it, if it says one.
template <primitive P>
CLEARANCE_HD bool may_reach(const P& primitive, const capsule& c, real reach) {
  if constexpr (requires {
                  { primitive.as_ball() } -> std::same_as<ball>;
                })
    return !(detail::bound_along(primitive.as_ball(), c) - c.radius > reach);
  return true;
}

/// A primitive's distance to a capsule, which is negative if they overlap by more than a touch.
template <primitive P>
CLEARANCE_HD real distance_to(const P& primitive, const capsule& c) {
  static_assert(swept_primitive<P>,
                "to be compared with what a point hides, a primitive needs: real least_along(vec3 from, vec3 along) "
                "const");
  const real away = primitive.distance(c.at(primitive.least_along(c.from, c.along)));
  // A way that passes through a surface comes to it within rounding.
  const bool touches = away >= 0 && away <= 0x1p-21f * (detail::size_of(c.from) + detail::size_of(c.along)) &&
                       away <= 0x1p-22f * (length(c.from) + length(c.along));
  return (touches ? 0 : away) - c.radius;
}

/// Shows a visitor how far primitives are from a capsule. The traversal itself walks with the capsule's start.
template <class Visitor>
struct of_capsule {
  using result_type = typename Visitor::result_type;

  Visitor& ask;
  const capsule& c;

  CLEARANCE_HD real reach() const { return ask.reach(); }
  template <class V>
  CLEARANCE_HD real bound(const V& volume, vec3) const {
    return lower_bound(volume, c, ask.reach());
  }
  CLEARANCE_HD void offer(std::uint32_t, real) {}
  template <class P>
  CLEARANCE_HD void offer(std::uint32_t id, real, const P& primitive) {
    if (!may_reach(primitive, c, ask.reach())) return;
    const real d = distance_to(primitive, c);
    if constexpr (requires { ask.offer(id, d, primitive); })
      ask.offer(id, d, primitive);
    else
      ask.offer(id, d);
  }
  CLEARANCE_HD result_type result() const { return ask.result(); }
};

}  // namespace clearance
