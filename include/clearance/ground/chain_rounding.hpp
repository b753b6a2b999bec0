// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How much rounding adds up along a chain of joints, so that places beyond what a bracket covers are refused.

#include <clearance/ground/pose.hpp>

namespace clearance {

/// How wrong double makes a link's place along a chain of joints. A bracket covers errors that are small against the
/// link's own way (half of its 2^-44 of that; the rest is for what comes after), and a nanometre, which its other terms
/// exceed. Ways that cancel lose more: going 1e13 m out and back leaves a millimetre that no bracket includes.
struct chain_rounding {
  double lost = 0;  ///< The largest error, metres.
  double turn = 0;  ///< The largest error of the rotation of the frame reached so far, radians.

  /// The frame moves by `way` metres, which are rotated, and is then `away` metres from where the chain began.
  CLEARANCE_HD void step(double way, double away) { lost += unit * away + (8 * unit + turn) * way; }
  /// The frame is at `before`, moves by `given` (rounded once, when it was written as a double), and is then at `sum`.
  /// `way` is the length of the one of the two that is rotated. Without a rotation an exact sum loses nothing more.
  CLEARANCE_HD void step(position before, position given, position sum, double way) {
    lost += unit * most(given);
    const auto exact = [](double x, double y, double s) { return s - x == y && s - y == x; };
    if (turn > 0 || !exact(before.x, given.x, sum.x) || !exact(before.y, given.y, sum.y) ||
        !exact(before.z, given.z, sum.z))
      step(way, most(sum));
  }
  /// The frame rotates; or it did before, if a chain is followed from its end.
  CLEARANCE_HD void turned() { turn += 16 * unit; }
  /// What rounding loses of a sum whose terms' magnitudes add up to `of`.
  CLEARANCE_HD static double of_sum(double of) { return 2 * unit * of; }
  /// May a link turn by so many radians? `of`: the magnitudes of the terms of this sum. Sines are known up to 2^30; a
  /// sum is known to a nanoradian up to 2^22.
  CLEARANCE_HD static bool turns(double by, double of, bool is_sum) {
    return absolute(by) <= 0x1p30 && (!is_sum || of <= 0x1p22);
  }
  CLEARANCE_HD bool covered(double away) const { return lost <= 1e-9 + 0x1p-45 * away; }

  /// Bounds on a length without a root: from below its largest coordinate, from above their sum.
  CLEARANCE_HD static double least(position p) { return larger(larger(absolute(p.x), absolute(p.y)), absolute(p.z)); }
  CLEARANCE_HD static double most(position p) { return absolute(p.x) + absolute(p.y) + absolute(p.z); }

 private:
  static constexpr double unit = 0x1p-53;
  CLEARANCE_HD static double absolute(double x) { return x < 0 ? -x : x; }
  CLEARANCE_HD static double larger(double a, double b) { return a > b ? a : b; }
};

}  // namespace clearance
