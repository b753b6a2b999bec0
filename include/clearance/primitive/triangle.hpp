// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/concepts.hpp>

#include <array>

namespace clearance {

/// A flat triangle, slivers and degenerate ones included; the distance is unsigned.
///
/// Three clamped segments are always right, so they decide; the plane is asked only where the point projects inside.
/// That test uses the unit normal made in double, so its error does not grow with the triangle's aspect, as it does in
/// region-based formulas (which lose centimetres on needles).
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
    const vec3 ab = b - a, bc = c - b, ca = a - c;
    const vec3 aq = q - a, bq = q - b, cq = q - c;
    const vec3 to_ab = to_segment(aq, ab), to_bc = to_segment(bq, bc), to_ca = to_segment(cq, ca);
    const real edge = square_root(min(min(dot(to_ab, to_ab), dot(to_bc, to_bc)), dot(to_ca, to_ca)));
    return above(ab, bc, ca, aq, bq, cq) ? min(edge, absolute(dot(aq, unit_normal))) : edge;
  }

  CLEARANCE_HD vec3 nearest(vec3 q) const {
    const vec3 ab = b - a, bc = c - b, ca = a - c;
    const vec3 aq = q - a, bq = q - b, cq = q - c;
    vec3 offset = to_segment(aq, ab);
    const vec3 others[2] = {to_segment(bq, bc), to_segment(cq, ca)};
    for (const vec3& o : others)
      if (dot(o, o) < dot(offset, offset)) offset = o;
    const real height = dot(aq, unit_normal);
    if (above(ab, bc, ca, aq, bq, cq) && absolute(height) <= length(offset)) offset = scaled(height, unit_normal);
    return q - offset;
  }

  CLEARANCE_HD vec3 normal(vec3 q) const {
    const vec3 d = q - nearest(q);
    const real l = length(d);
    return l > 0 ? scaled(divide(1, l), d) : unit_normal;
  }

  std::array<ball, 3> balls() const { return {{{a, 0}, {b, 0}, {c, 0}}}; }

 private:
  /// From the nearest point of the segment (start at 0, along `edge`) to `p`.
  CLEARANCE_HD static vec3 to_segment(vec3 p, vec3 edge) {
    const real squared = dot(edge, edge);
    const real t = squared > 0 ? clamp01(divide(dot(p, edge), squared)) : 0;
    return fma(-t, edge, p);
  }
  /// Does the point project strictly inside? One sign a side, measured from that side's own corner.
  CLEARANCE_HD bool above(vec3 ab, vec3 bc, vec3 ca, vec3 aq, vec3 bq, vec3 cq) const {
    return dot(cross(unit_normal, ab), aq) > 0 && dot(cross(unit_normal, bc), bq) > 0 && dot(cross(unit_normal, ca), cq) > 0;
  }
};

static_assert(primitive<triangle>);

}  // namespace clearance
