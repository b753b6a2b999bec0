// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A triangle of a mesh, with distances that are also right for needles and for what has no area.

#include <clearance/concepts/capsule.hpp>
#include <clearance/ground/math.hpp>

#include <array>

namespace clearance {

/// Which place of a way (from + t along, 0 <= t <= 1) is nearest to another way, as its t. In double, because nearly
/// parallel ways lose half of the digits. (Lumelsky 1985.)
CLEARANCE_HD inline real share_nearest(vec3 from, vec3 along, vec3 other_from, vec3 other_along) {
  struct way {
    double x, y, z;
    CLEARANCE_HD double operator*(const way& b) const { return fma(x, b.x, fma(y, b.y, z * b.z)); }
  };
  const way e{along.x, along.y, along.z}, u{other_along.x, other_along.y, other_along.z},
      r{double(from.x) - other_from.x, double(from.y) - other_from.y, double(from.z) - other_from.z};
  const auto clamped = [](double t) { return t > 0 ? (t < 1 ? t : 1) : 0; };
  const double ee = e * e, uu = u * u, eu = e * u, er = e * r, ur = u * r;
  if (!(ee > 0)) return 0;
  const double square = fma(ee, uu, -(eu * eu));
  // Ways that are less than 1e-7 from parallel keep their distance within 1e-7 of their length.
  double t = square > 1e-14 * ee * uu ? clamped(fma(eu, ur, -(er * uu)) / square) : 0;
  const double s = uu > 0 ? fma(eu, t, ur) / uu : 0;
  if (!(s > 0)) t = clamped(-er / ee);
  if (s > 1) t = clamped((eu - er) / ee);
  return real(t);
}

/// A flat triangle, slivers and degenerate ones included; the distance is unsigned.
///
/// Three clamped segments are always right, so they decide. The plane is asked only if the point surely projects
/// inside: every side's sign says so, and the nearest side is nearest with its interior (inside a convex polygon no
/// corner is the nearest). Signs alone would pass points beyond the tip of a needle, metres away. The unit normal is
/// made in double, so that errors do not grow with the triangle's aspect as in region-based formulas.
struct triangle {
  vec3 a, b, c;
  vec3 unit_normal;  ///< (b-a) x (c-a), normalised in double; (0,0,0) for a triangle without area.

  static triangle from(vec3 a, vec3 b, vec3 c) {
    // By to_float, because corners may have been rounded just before.
    const auto way = [](real to, real from) { return double(to_float(to)) - double(to_float(from)); };
    const double ux = way(b.x, a.x), uy = way(b.y, a.y), uz = way(b.z, a.z);
    const double vx = way(c.x, a.x), vy = way(c.y, a.y), vz = way(c.z, a.z);
    const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    const double l = std::sqrt(nx * nx + ny * ny + nz * nz);
    const double edges = std::sqrt((ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz));
    // Below this ratio the double normal itself is noise; the segments are then exact to 1e-9 of an edge.
    if (!(l > 1e-9 * edges)) return {a, b, c, {0, 0, 0}};
    return {a, b, c, {real(nx / l), real(ny / l), real(nz / l)}};
  }

  /// Is the normal that of the corners, as `from` makes it? `build` asks, because distances rely on it.
  bool consistent() const {
    const vec3 off = unit_normal - from(a, b, c).unit_normal;
    return absolute(off.x) <= 0x1p-21f && absolute(off.y) <= 0x1p-21f && absolute(off.z) <= 0x1p-21f;
  }

  CLEARANCE_HD real distance(vec3 q) const {
    const measured m = measure(q);
    return m.over_face ? min(m.edge, absolute(m.height) + 0.0f) : m.edge;  // + 0: never -0
  }

  /// `distance` but for one root: see rootless_primitive.
  struct rootless {
    real squared;  ///< The squared distance to the nearest side.
    real inner;    ///< The least square to a side whose interior is nearest; NaN: the point does not project inside.
    real noise, height;

    CLEARANCE_HD real distance(real root) const {
      return choice(inner <= nearly(root, noise), min(root, absolute(height) + 0.0f), root);
    }
  };
  CLEARANCE_HD rootless before_root(vec3 q) const {
    const seen<false, true> s(*this, q);
    return {s.least.squared, choice(over_face(s), s.inner, not_a_number), s.noise, dot(s.aq, unit_normal)};
  }

  /// May the point be within reach? By rough distances, whose rounding is allowed for. Only the sides' signs say
  /// whether q is over the face.
  CLEARANCE_HD bool may_reach(vec3 q, real reach) const {
    const vec3 ab = b - a, bc = c - b, ca = a - c;
    const vec3 aq = q - a, bq = q - b, cq = q - c;
    const real noise = 0x1p-20f * (extent(aq) + extent(ab) + extent(ca));
    const real edges = min(min(rough_square(aq, ab), rough_square(bq, bc)), rough_square(cq, ca)),
               height = dot(aq, unit_normal);
    const real inward =
        min(min(dot(cross(unit_normal, ab), aq), dot(cross(unit_normal, bc), bq)), dot(cross(unit_normal, ca), cq));
    const real beside = positive_part(-inward) * largest_real;
    return min(edges, height * height + beside) <= square_of_reach(reach + noise);
  }

  /// Never above `distance(q)`, and hardly below it except over the tips of needles. It takes half the work: the same
  /// formulas with rough quotients and roots.
  CLEARANCE_HD real lower_bound(vec3 q) const {
    const vec3 ab = b - a, bc = c - b, ca = a - c;
    const vec3 aq = q - a, bq = q - b, cq = q - c;
    const real ab2 = dot(ab, ab), bc2 = dot(bc, bc), ca2 = dot(ca, ca);
    const real edge =
        rough_root(rough_min(rough_min(near_side(aq, ab, ab2), near_side(bq, bc, bc2)), near_side(cq, ca, ca2)));
    const bool perhaps_over = over_face(ab, bc, ca, aq, bq, cq);
    const real d = perhaps_over ? rough_min(edge, absolute(dot(aq, unit_normal))) : edge;
    const real size = 2 * rough_root(rough_max(ab2, ca2));
    return d - fma(slack, d + size, 0x1p-60f);  // the last term because squares below 1e-38 are 0
  }

  /// Along the rough way from the nearest point. No corner lies beyond the half-space, which holds for any direction.
  CLEARANCE_HD primitive_tangent tangent_at(vec3 q) const {
    const vec3 aq = q - a, bq = q - b, cq = q - c;
    const unit_way way(away<true>(q));
    const vec3 u = way.direction;
    const real off = slack * (way.length + extent(b - a) + extent(c - a)) + 0x1p-60f;
    return {{rough_min(rough_min(dot(u, aq), dot(u, bq)), dot(u, cq)) - off, u}, way.length + off, way.length};
  }

  /// A ball around the triangle, for quick tests.
  CLEARANCE_HD ball as_ball() const {
    const vec3 ab = b - a, ac = c - a, way{(ab.x + ac.x) / 3, (ab.y + ac.y) / 3, (ab.z + ac.z) / 3}, middle = a + way;
    const real square = rough_max(rough_max(dot(way, way), dot(ab - way, ab - way)), dot(ac - way, ac - way));
    return {middle, rough_root(square) * (1 + 4 * slack) + slack * (extent(middle) + extent(way))};
  }
  /// See swept_primitive. An end, where the way crosses the plane, or the place that is nearest to a side is nearest;
  /// where no corner lies ahead, as before most of what a camera sees, the start is.
  CLEARANCE_HD real least_along(vec3 from, vec3 along) const {
    if (dot(a - from, along) <= 0 && dot(b - from, along) <= 0 && dot(c - from, along) <= 0) return 0;
    const real height = dot(from - a, unit_normal), rise = dot(along, unit_normal);
    const real shares[] = {0,
                           1,
                           rise < 0 || rise > 0 ? clamp01(divide(-height, rise)) : 0,
                           share_nearest(from, along, a, b - a),
                           share_nearest(from, along, b, c - b),
                           share_nearest(from, along, c, a - c)};
    real best = 0, least = infinity;
    for (const real t : shares)
      if (const real d = distance(fma(t, along, from)); d < least) {
        best = t;
        least = d;
      }
    return best;
  }

  CLEARANCE_HD vec3 nearest(vec3 q) const { return q - away(q); }
  CLEARANCE_HD core_place core_at(vec3 q) const { return {nearest(q), 0}; }

  CLEARANCE_HD vec3 normal(vec3 q) const {
    const vec3 d = away(q);
    const real l = length(d);
    return l > 0 ? scaled(divide(1, l), d) : unit_normal;
  }

  std::array<ball, 3> balls() const { return {{{a, 0}, {b, 0}, {c, 0}}}; }

 private:
  struct measured {
    vec3 offset;     ///< From the nearest point of the three sides to the query point.
    real edge;       ///< The length of `offset`.
    real height;     ///< Height above the plane.
    bool over_face;  ///< Does the query point surely project inside?
  };
  struct side {
    vec3 offset;
    real squared;
    bool interior;  ///< The interior is nearest, not a corner.
  };

  /// The three sides from a point. `Rough`: with quotients for bounds. `Looped`: without branches.
  template <bool Rough, bool Looped>
  struct seen {
    vec3 ab, bc, ca, aq, bq, cq;
    real noise;
    side least;  ///< The nearest side.
    real inner;  ///< The least square to a side whose interior is nearest, or NaN.

    CLEARANCE_HD seen(const triangle& t, vec3 q)
        : ab(t.b - t.a),
          bc(t.c - t.b),
          ca(t.a - t.c),
          aq(q - t.a),
          bq(q - t.b),
          cq(q - t.c),
          // The uncertainty of positions. The factor is a power of two, so that contraction changes no bit.
          noise(0x1p-22f * (extent(aq) + extent(ab) + extent(ca))),
          least(to_side<Rough, Looped>(aq, ab, noise)),
          inner(choice<Looped>(least.interior, least.squared, not_a_number)) {
      add(to_side<Rough, Looped>(bq, bc, noise));
      add(to_side<Rough, Looped>(cq, ca, noise));
    }
    CLEARANCE_HD void add(const side& s) {
      const bool nearer = s.squared < least.squared;
      least.offset = choice<Looped>(nearer, s.offset, least.offset);
      least.squared = choice<Looped>(nearer, s.squared, least.squared);
      inner = choice<Looped>(bool(int(s.interior) & int(!(inner <= s.squared))), s.squared, inner);
    }
  };

  template <bool Rough = false>
  CLEARANCE_HD measured measure(vec3 q) const {
    const seen<Rough, Rough> s(*this, q);
    const real edge = Rough ? looped_root(s.least.squared) : square_root(s.least.squared);
    const bool interior = s.inner <= nearly(edge, s.noise);
    const bool over = Rough ? bool(int(interior) & int(over_face(s))) : interior && over_face(s);
    return {s.least.offset, edge, dot(s.aq, unit_normal), over};
  }
  CLEARANCE_HD static real nearly(real edge, real noise) { return (edge + noise) * (edge + noise); }
  /// From the nearest point to the query point.
  template <bool Rough = false>
  CLEARANCE_HD vec3 away(vec3 q) const {
    const measured m = measure<Rough>(q);
    const bool face = bool(int(m.over_face) & int(absolute(m.height) <= m.edge));
    return choice<Rough>(face, scaled(m.height, unit_normal), m.offset);
  }
  /// A side that starts at 0 and goes along `edge`.
  template <bool Rough, bool Looped>
  CLEARANCE_HD static side to_side(vec3 p, vec3 edge, real noise) {
    const real length2 = dot(edge, edge);
    const bool any = length2 > (Rough ? least_normal : 0);
    const real t = ratio<Rough>(choice<Looped>(any, dot(p, edge), 0), choice<Looped>(any, length2, 1)),
               beyond = max(-t, t - 1);
    const vec3 offset = fma(-min(max(t, 0), 1), edge, p);
    return {offset, dot(offset, offset), bool(int(beyond < 0) | int(beyond * beyond * length2 <= noise * noise))};
  }
  template <bool Rough>
  CLEARANCE_HD static real ratio(real a, real b) {
    return Rough ? a * rough_inverse(b) : divide(a, b);
  }
  /// The squared distance to a side.
  CLEARANCE_HD static real rough_square(vec3 p, vec3 edge) {
    const real t = dot(p, edge) * (1 / (dot(edge, edge) + least_normal));
    const vec3 offset = fma(positive_part(1 - positive_part(t)) - 1, edge, p);
    return dot(offset, offset);
  }
  /// Decided by every side's sign.
  template <class Seen>
  CLEARANCE_HD bool over_face(const Seen& s) const {
    return over_face(s.ab, s.bc, s.ca, s.aq, s.bq, s.cq);
  }
  CLEARANCE_HD bool over_face(vec3 ab, vec3 bc, vec3 ca, vec3 aq, vec3 bq, vec3 cq) const {
    return bool(int(dot(cross(unit_normal, ab), aq) > 0) & int(dot(cross(unit_normal, bc), bq) > 0) &
                int(dot(cross(unit_normal, ca), cq) > 0));
  }
  CLEARANCE_HD static real near_side(vec3 p, vec3 edge, real length2) {
    const vec3 offset = fma(-saturated(dot(p, edge) * rough_inverse(length2)), edge, p);
    return dot(offset, offset);
  }
  CLEARANCE_HD static real extent(vec3 v) { return absolute(v.x) + absolute(v.y) + absolute(v.z); }
};

static_assert(bounded_primitive<triangle> && swept_primitive<triangle>);

}  // namespace clearance
