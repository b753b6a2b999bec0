// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/pose.hpp>

namespace clearance {

/// What double loses of a link's place along a chain of joints. A bracket covers what is little against the link's own
/// way (half of its 2^-44 of that; the rest is for what comes after), and a nanometre, which its other terms are above.
/// Ways that cancel lose more: origins of 1e13 m and back leave a millimetre that no bracket knows of.
struct chain_rounding {
  double lost = 0;  ///< Metres, at most.
  double turn = 0;  ///< By how much the frame reached so far may be turned wrongly, radians.

  /// A frame goes on by `way` metres, which are turned, and is then `away` metres from where the chain began.
  CLEARANCE_HD void step(double way, double away) { lost += unit * away + (8 * unit + turn) * way; }
  /// It is at `before`, goes on by what is `given` (and was rounded once, when it was written as a double), and is then
  /// at `sum`; `way` is the length of which of the two is turned. Where nothing is turned, an exact sum loses no more.
  CLEARANCE_HD void step(position before, position given, position sum, double way) {
    lost += unit * most(given);
    const auto exact = [](double x, double y, double s) { return s - x == y && s - y == x; };
    if (turn > 0 || !exact(before.x, given.x, sum.x) || !exact(before.y, given.y, sum.y) ||
        !exact(before.z, given.z, sum.z))
      step(way, most(sum));
  }
  /// And it turns; or did before, where a chain is followed from its end.
  CLEARANCE_HD void turned() { turn += 16 * unit; }
  CLEARANCE_HD bool covered(double away) const { return lost <= 1e-9 + 0x1p-45 * away; }

  /// A length from below by its largest coordinate, and from above by their sum: no root is drawn.
  CLEARANCE_HD static double least(position p) { return larger(larger(absolute(p.x), absolute(p.y)), absolute(p.z)); }
  CLEARANCE_HD static double most(position p) { return absolute(p.x) + absolute(p.y) + absolute(p.z); }

 private:
  static constexpr double unit = 0x1p-53;
  CLEARANCE_HD static double absolute(double x) { return x < 0 ? -x : x; }
  CLEARANCE_HD static double larger(double a, double b) { return a > b ? a : b; }
};

}  // namespace clearance
