// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/config.hpp>

#include <cmath>

namespace clearance {

/// A triangle of a closed surface, as the crossing rule reads it.
template <class T>
struct crossing_triangle {
  T v[3][3];
};

namespace crossing {

/// A fused product and sum: rounded once, on host and device alike.
CLEARANCE_HD inline double fused(double a, double b, double c) {
#if defined(__CUDA_ARCH__)
  return __fma_rn(a, b, c);
#else
  return std::fma(a, b, c);
#endif
}

/// a * b - c * d to 1.5 units of rounding, so its sign is right (Kahan; Jeannerod, Louvet & Muller 2013).
CLEARANCE_HD inline double difference_of_products(double a, double b, double c, double d) {
  const double w = c * d;
  return fused(a, b, -w) + fused(-c, d, w);
}

/// +1 if the point (y, z) lies left of the line from u to v in the (y, z) plane, -1 if right. On the line, the point
/// counts as (y + e, z + e * e) for a tiny e. So the answer is 0 only if u and v coincide, and swapping u and v always
/// swaps the sign. Where the ray meets an edge or a vertex, exactly those triangles count that a nearby ray would meet.
template <class T>
CLEARANCE_HD inline int side(const T (&u)[3], const T (&v)[3], double y, double z) {
  const double uy = u[1], uz = u[2], vy = v[1], vz = v[2];
  const double first = (vy - uy) * (z - uz), second = (vz - uz) * (y - uy);
  const double quick = first - second, size = (first < 0 ? -first : first) + (second < 0 ? -second : second);
  // Larger than the rounding of four differences, two products and one more difference: no closer look is needed.
  if (quick > 0x1p-49 * size && size > 0x1p-900) return 1;
  if (-quick > 0x1p-49 * size && size > 0x1p-900) return -1;
  const bool swapped = vy < uy || (vy == uy && vz < uz);  // both triangles of an edge use the same numbers
  const double ay = swapped ? vy : uy, az = swapped ? vz : uz, by = swapped ? uy : vy, bz = swapped ? uz : vz;
  const double d = difference_of_products(by - ay, z - az, bz - az, y - ay);
  const int tie = az != bz ? (az > bz ? 1 : -1) : by != ay ? (by > ay ? 1 : -1) : 0;
  const int s = d > 0 ? 1 : d < 0 ? -1 : tie;
  return swapped ? -s : s;
}

/// The triangle's contribution to the winding number at (x, y, z): +1 where the ray towards +x leaves through it, -1
/// where it enters, 0 where it misses.
template <class T>
CLEARANCE_HD inline int sign(const crossing_triangle<T>& t, double x, double y, double z) {
  const T &ay = t.v[0][1], &by = t.v[1][1], &cy = t.v[2][1], &az = t.v[0][2], &bz = t.v[1][2], &cz = t.v[2][2];
  if ((ay < y && by < y && cy < y) || (ay > y && by > y && cy > y)) return 0;
  if ((az < z && bz < z && cz < z) || (az > z && bz > z && cz > z)) return 0;
  const double ax = t.v[0][0], bx = t.v[1][0], cx = t.v[2][0];
  if (ax < x && bx < x && cx < x) return 0;
  const int s = side(t.v[0], t.v[1], y, z);
  if (s == 0 || side(t.v[1], t.v[2], y, z) != s || side(t.v[2], t.v[0], y, z) != s) return 0;
  if (ax > x && bx > x && cx > x) return s;
  // s also has the sign of the normal's x, so the plane is ahead where normal * (p - a) has the other sign.
  const double uy = by - double(ay), uz = bz - double(az), ux = bx - ax, vy = cy - double(ay), vz = cz - double(az),
               vx = cx - ax;
  const double nx = difference_of_products(uy, vz, uz, vy), ny = difference_of_products(uz, vx, ux, vz),
               nz = difference_of_products(ux, vy, uy, vx);
  const double above = fused(nx, x - ax, fused(ny, y - ay, nz * (z - az)));
  return (s > 0 ? above < 0 : above > 0) ? s : 0;
}

}  // namespace crossing
}  // namespace clearance
