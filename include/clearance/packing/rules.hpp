// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/math.hpp>

namespace clearance {

/// Which part of a solid is looked at next, on host and device. `depth` and `gap` are the distances from a cell's
/// middle to the surface and to the spheres, `reach` that to its corners.
struct pack_rules {
  double gap_per_radius;
  bool promotes;     ///< Is it finite?
  double smallest;   ///< The least radius.
  double trust = 1;  ///< In a cell's bound.

  static constexpr double promotion = 8;  ///< A cell goes before ones with at most so much more room.

  pack_rules(double per_radius, double smallest)
      : gap_per_radius(per_radius), promotes(per_radius < double(infinity)), smallest(smallest) {}

  /// What is taken first: the largest bound; but where the spheres are much farther than it is large, as in thin walls
  /// and sharp corners, a cell may be taken before its turn.
  CLEARANCE_HD double key(double depth, double reach, double gap) const {
    const double bound = (depth < gap ? depth : gap) + trust * reach, wanted = (gap + trust * reach) / gap_per_radius;
    const double key = !promotes || wanted < bound ? bound : wanted > promotion * bound ? promotion * bound : wanted;
    // With little trust it may be negative. It is kept above 0, in the same order, for every cell has its turn: the key
    // that is the largest is always at least some part of the largest.
    const double last = 1e-3 * smallest;
    return key > last ? key : last / (2 - key / last);
  }
  /// Is a cell too small to be divided? So no cell is divided for ever: from one of these no sphere can be climbed to
  /// that floats can tell, or the largest that is there is a 2^-30th below the smallest.
  CLEARANCE_HD bool finest(double reach) const { return reach < 0x1p-30 * smallest; }
  /// Is a cell so small against its room that it is climbed from? Else it is divided.
  CLEARANCE_HD bool small(double room, double reach) const {
    const double least = 1 - 0.25 / trust;
    return room >= (least > 0.25 ? least : 0.25) * (room + reach);
  }
  /// Gaps so large that they change no key need not be known.
  CLEARANCE_HD double farthest_gap(double bound) const { return promotes ? promotion * gap_per_radius * bound : bound; }
};

}  // namespace clearance
