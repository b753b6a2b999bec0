// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/math.hpp>

namespace clearance {

/// Decides which part of a solid comes next, on host and device. `depth` and `gap` are the distances from a cell's
/// middle to the surface and to the spheres; `reach` is that to its corners.
struct pack_rules {
  double gap_per_radius;
  bool promotes;     ///< Is it finite?
  double smallest;   ///< The least radius.
  double trust = 1;  ///< How far a cell's bound is trusted, at most 1.

  static constexpr double promotion = 8;  ///< A cell may overtake others with up to this many times its room.

  pack_rules(double per_radius, double smallest)
      : gap_per_radius(per_radius), promotes(per_radius < double(infinity)), smallest(smallest) {}

  /// The largest bound comes first. But where the spheres are much farther away than the bound, as in thin walls and
  /// sharp corners, a cell may come before its turn.
  CLEARANCE_HD double key(double depth, double reach, double gap) const {
    const double bound = (depth < gap ? depth : gap) + trust * reach, wanted = (gap + trust * reach) / gap_per_radius;
    const double key = !promotes || wanted < bound ? bound : wanted > promotion * bound ? promotion * bound : wanted;
    // With little trust the key may be negative. It stays above 0, in the same order, so that every cell gets its turn:
    // the largest key is always at least some fraction of the largest.
    const double last = 1e-3 * smallest;
    return key > last ? key : last / (2 - key / last);
  }
  /// Is a cell too small to divide? So division ends: a climb from here finds no sphere that floats can represent, or
  /// the largest is a 2^-30th below the least radius.
  CLEARANCE_HD bool finest(double reach) const { return reach < 0x1p-30 * smallest; }
  /// Is a cell small enough against its room to climb from? Otherwise it is divided.
  CLEARANCE_HD bool small(double room, double reach) const {
    const double least = 1 - 0.25 / trust;
    return room >= (least > 0.25 ? least : 0.25) * (room + reach);
  }
  /// Gaps above this change no key, so they need not be known exactly.
  CLEARANCE_HD double farthest_gap(double bound) const { return promotes ? promotion * gap_per_radius * bound : bound; }
};

}  // namespace clearance
