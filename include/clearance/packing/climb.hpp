// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/packing/room_view.hpp>

namespace clearance {

/// Who tries the directions of a climb: one lane tries all; several share them, and agree on the best.
struct one_lane {
  CLEARANCE_HD int rank() const { return 0; }
  CLEARANCE_HD int lanes() const { return 1; }
  CLEARANCE_HD void agree(double&, int&) const {}
};

/// The six axes and eight diagonals.
CLEARANCE_HD inline vec3d compass(int k) {
  if (k < 6) {
    const double s = k & 1 ? 1 : -1;
    return {k / 2 == 0 ? s : 0, k / 2 == 1 ? s : 0, k / 2 == 2 ? s : 0};
  }
  constexpr double c = 0.5773502691896258;
  return {k & 1 ? c : -c, k & 2 ? c : -c, (k - 6) & 4 ? c : -c};
}

/// Compass search for a place that `worth(p, least)` more than `from` is; it returns what p is worth, or anything not
/// above `least`, and what is worth at most `step` more a step of that length away.
template <class Lanes, class F>
CLEARANCE_HD solid_sphere search(const solid_sphere& from, double precision, Lanes lanes, F worth) {
  solid_sphere now = from;
  for (double step = now.radius / 2; step > precision * now.radius;) {
    double best = now.radius + 0.02 * step;  // less is not worth a step of this size
    int way = 14;
    for (int k = lanes.rank(); k < 14; k += lanes.lanes()) {
      const double r = worth(now.center + step * compass(k), now.radius + step, best);
      if (r > best) best = r, way = k;
    }
    lanes.agree(best, way);
    if (way < 14) {
      now = {now.center + step * compass(way), best};
      step = 1.5 * step < 0.9 * best ? 1.5 * step : 0.9 * best;
    } else {
      step /= 2;
    }
  }
  return now;
}

/// Moves an inside sphere, which no other may touch, to a local maximum of the room, not farther than `farthest`. Each
/// step stays in the ball that is known to be inside, so none can leave the solid through a thin wall.
template <class Lanes>
CLEARANCE_HD solid_sphere climb(const room_view& in, const solid_sphere& from, double farthest, Lanes lanes) {
  return search(from, 1e-3, lanes, [&](const vec3d& p, double most, double least) {
    return (p - from.center).norm() > farthest ? 0 : in.room(p, most * (1 + 1e-12), least);
  });
}

/// Moves and grows an inside sphere, whatever spheres are in the way, while it covers the middle of what it was.
template <class Lanes>
CLEARANCE_HD solid_sphere grow(const mesh_solid_view& in, const solid_sphere& from, Lanes lanes) {
  return search(from, 1e-2, lanes, [&](const vec3d& p, double most, double least) {
    const double r = in.distance(p, most * (1 + 1e-12), least);
    return (p - from.center).norm() <= r - from.radius / 2 ? r : 0;
  });
}

}  // namespace clearance
