// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Moves a sphere, step by step, to where a larger one fits.

#include <clearance/ground/vectors.hpp>
#include <clearance/solid/eight.hpp>
#include <clearance/solid/vec3d.hpp>

#include <span>

namespace clearance {

struct solid_sphere {
  vec3d center;
  double radius;

  CLEARANCE_HD double distance(const vec3d& p) const { return (p - center).norm() - radius; }
  /// The distance if it is below `best`, else `best`. Takes a root only for what is nearer.
  CLEARANCE_HD double nearer(const vec3d& p, double best) const {
    const vec3d way = p - center;
    const double square = way.dot(way), reach = best + radius;
    if (!(reach > 0 && square < reach * reach)) return best;
    const double d = ::sqrt(square) - radius;
    return d < best ? d : best;
  }
  /// The same for eight places side by side, whose distances so far are `best`.
  void nearer(const eighths& p, eight& best) const {
    with_wide_vectors([&] { lower(p, best); });
  }

 private:
  void lower(const eighths& p, eight& best) const {
    eight d;
    std::int64_t near = 0;
    for (int k = 0; k < 8; ++k) {
      const vec3d way = p[k] - center;
      const double reach = best.v[k] + radius;
      d.v[k] = way.dot(way);
      near |= ((reach > 0) & (d.v[k] < reach * reach)) ? 1 : 0;
    }
    if (near == 0) return;
    take_roots(d);
    for (int k = 0; k < 8; ++k) best.v[k] = d.v[k] - radius < best.v[k] ? d.v[k] - radius : best.v[k];
  }
};

/// Is any of these spheres nearer to p than `reach`? Most are not, which a host sees for several at a time.
inline bool any_near(std::span<const solid_sphere> some, const vec3d& p, double reach) {
  std::int64_t near = 0;
  with_wide_vectors([&] {
    const vec3d at = p;
    const double within = reach;
    std::int64_t any = 0;
    for (const solid_sphere& s : some) {
      const vec3d way = at - s.center;
      const double r = within + s.radius;
      any |= ((r > 0) & (way.dot(way) < r * r)) ? 1 : 0;
    }
    near = any;
  });
  return near != 0;
}

/// Who tries the directions of a climb: one lane tries all; several lanes share them and agree on the best.
struct one_lane {
  CLEARANCE_HD int rank() const { return 0; }
  CLEARANCE_HD int lanes() const { return 1; }
  CLEARANCE_HD void meet() const {}
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

/// Compass search for a place worth more. `worth(p, most, least)` is at most `most`; if the true worth is not above
/// `least`, it may be anything not above `least`. `prepare(now)` runs before each step. The search ends: each step
/// raises the worth by a 5e4th (and no place is worth more than the solid is large), or is halved.
CLEARANCE_CALLS_ANYTHING
template <class Lanes, class G, class F>
CLEARANCE_HD solid_sphere compass_search(const solid_sphere& from, double precision, Lanes lanes, G prepare, F worth) {
  solid_sphere now = from;
  for (double step = now.radius / 2; step > precision * now.radius;) {
    prepare(now);
    double best = now.radius + 0.02 * step;  // less is not worth a step of this size
    int way = 14;
    for (int k = lanes.rank(); k < 14; k += lanes.lanes()) {
      const double r = worth(now.center + step * compass(k), now.radius + step, best);
      if (r > best) {
        best = r;
        way = k;
      }
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

}  // namespace clearance
