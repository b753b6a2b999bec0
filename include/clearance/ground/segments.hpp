// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/math.hpp>

namespace clearance {

/// Which place of a way (from + t along, 0 <= t <= 1) is nearest to another one: its t. In double, because nearly
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

}  // namespace clearance
