// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Sine and cosine with the same bits everywhere. Those of libraries differ in the last bit.

#include <clearance/ground/math.hpp>

namespace clearance {

struct sine_cosine {
  double sine, cosine;
};

/// Sine and cosine of an angle in radians, within 2e-16. NaN beyond 2^30 rad, where a double says little about an
/// angle.
CLEARANCE_HD inline sine_cosine sine_cosine_of(double angle) {
  if (!(-0x1p30 <= angle && angle <= 0x1p30)) return {double(not_a_number), double(not_a_number)};
  // Subtracts whole quarter turns, with pi / 2 in two doubles, so that the cancellation is exact enough.
  const double quarters = fma(angle, 0x1.45f306dc9c883p-1, angle < 0 ? -0.5 : 0.5);
  const long long turns = static_cast<long long>(quarters);
  const double r = fma(-double(turns), 0x1.1a62633145c07p-54, fma(-double(turns), 0x1.921fb54442d18p+0, angle)),
               rr = r * r;
  // Taylor's series: the first term left out is below 5e-17 at an eighth of a turn.
  constexpr double odd[] = {1.0 / 6227020800, -1.0 / 39916800, 1.0 / 362880, -1.0 / 5040, 1.0 / 120, -1.0 / 6};
  constexpr double even[] = {-1.0 / 87178291200, 1.0 / 479001600, -1.0 / 3628800, 1.0 / 40320,
                             -1.0 / 720,         1.0 / 24,        -1.0 / 2};
  double s = -1.0 / 1307674368000, c = 1.0 / 20922789888000;
  for (int k = 0; k < 6; ++k) s = fma(s, rr, odd[k]);
  for (int k = 0; k < 7; ++k) c = fma(c, rr, even[k]);
  s = fma(s * rr, r, r), c = fma(c, rr, 1.0);
  switch (turns & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

}  // namespace clearance
