// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/concepts.hpp>

#include <array>

namespace clearance {

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
    const double ux = double(b.x) - a.x, uy = double(b.y) - a.y, uz = double(b.z) - a.z;
    const double vx = double(c.x) - a.x, vy = double(c.y) - a.y, vz = double(c.z) - a.z;
    const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    const double l = std::sqrt(nx * nx + ny * ny + nz * nz);
    const double edges = std::sqrt((ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz));
    // Below this ratio the double normal itself is noise; the segments are then exact to 1e-9 of an edge.
    if (!(l > 1e-9 * edges)) return {a, b, c, {0, 0, 0}};
    return {a, b, c, {real(nx / l), real(ny / l), real(nz / l)}};
  }

  CLEARANCE_HD real distance(vec3 q) const {
    const measured m = measure(q);
    return m.over_face ? min(m.edge, absolute(m.height) + 0.0f) : m.edge;  // + 0: never -0
  }

  /// Like `distance`, but rounded roughly, which it allows for. Only the sides' signs say whether q is over the face.
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

  CLEARANCE_HD vec3 nearest(vec3 q) const { return q - away(q); }

  CLEARANCE_HD vec3 normal(vec3 q) const {
    const vec3 d = away(q);
    const real l = length(d);
    return l > 0 ? scaled(divide(1, l), d) : unit_normal;
  }

  std::array<ball, 3> balls() const { return {{{a, 0}, {b, 0}, {c, 0}}}; }

 private:
  struct measured {
    vec3 offset;     ///< From the nearest point of the three sides to the query point,
    real edge;       ///< and its length.
    real height;     ///< Height above the plane.
    bool over_face;  ///< Does the query point surely project inside?
  };
  struct side {
    vec3 offset;
    real squared;
    bool interior;  ///< The interior is nearest, not a corner.
  };

  /// `Rough`: with quotients and roots for bounds.
  template <bool Rough = false>
  CLEARANCE_HD measured measure(vec3 q) const {
    const vec3 ab = b - a, bc = c - b, ca = a - c;
    const vec3 aq = q - a, bq = q - b, cq = q - c;
    // The uncertainty of positions below. The factor is a power of two, so that contraction changes no bit.
    const real noise = 0x1p-22f * (extent(aq) + extent(ab) + extent(ca));
    const side sides[3] = {to_side<Rough>(aq, ab, noise), to_side<Rough>(bq, bc, noise), to_side<Rough>(cq, ca, noise)};
    side least = sides[0];
    for (const side& s : sides) {
      const bool nearer = s.squared < least.squared;
      least.offset = choice<Rough>(nearer, s.offset, least.offset);
      least.squared = choice<Rough>(nearer, s.squared, least.squared);
    }
    measured m{least.offset, Rough ? looped_root(least.squared) : square_root(least.squared), dot(aq, unit_normal),
               false};
    const real nearly = (m.edge + noise) * (m.edge + noise);
    int interior = 0;
    for (const side& s : sides) interior |= int(s.interior) & int(s.squared <= nearly);
    m.over_face = bool(interior & int(over_face(ab, bc, ca, aq, bq, cq)));
    return m;
  }
  /// From the nearest point to the query point.
  template <bool Rough = false>
  CLEARANCE_HD vec3 away(vec3 q) const {
    const measured m = measure<Rough>(q);
    const bool face = bool(int(m.over_face) & int(absolute(m.height) <= m.edge));
    return choice<Rough>(face, scaled(m.height, unit_normal), m.offset);
  }
  /// A side that starts at 0 and goes along `edge`.
  template <bool Rough>
  CLEARANCE_HD static side to_side(vec3 p, vec3 edge, real noise) {
    const real length2 = dot(edge, edge);
    const bool any = length2 > (Rough ? least_normal : 0);
    const real t = ratio<Rough>(choice<Rough>(any, dot(p, edge), 0), choice<Rough>(any, length2, 1)),
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

static_assert(bounded_primitive<triangle>);

}  // namespace clearance
