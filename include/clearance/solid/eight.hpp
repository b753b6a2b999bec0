// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Eight numbers, and the middles of a cube's eighths, side by side: a host asks about all eight at once.

#include <clearance/ground/math.hpp>
#include <clearance/solid/vec3d.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace clearance {

/// Eight numbers, aligned for vectors.
struct alignas(64) eight {
  double v[8];

  static eight of(double x) {
    eight made;
    for (double& each : made.v) each = x;
    return made;
  }
  /// The largest if it is above `enough`, else minus infinity.
  double largest_above(double enough) const {
    double most[4];
    for (int k = 0; k < 4; ++k) most[k] = v[k] > v[k + 4] ? v[k] : v[k + 4];
    for (int k = 0; k < 2; ++k) most[k] = most[k] > most[k + 2] ? most[k] : most[k + 2];
    const double largest = most[0] > most[1] ? most[0] : most[1];
    return largest > enough ? largest : -double(infinity);
  }
};

/// Correctly rounded roots. (A loop over sqrt stays scalar, because a root may set errno.)
inline void take_roots(eight& of) {
#if defined(__SSE2__)
  for (int i = 0; i < 8; i += 2) _mm_store_pd(of.v + i, _mm_sqrt_pd(_mm_load_pd(of.v + i)));
#else
  for (double& each : of.v) each = std::sqrt(each);
#endif
}

/// The middles of a cube's eighths: eight places near one another.
struct eighths {
  eight x, y, z;
  vec3d middle;      ///< Between the first and the last.
  double apart = 0;  ///< How far they are from it along each axis, at most.

  /// `place(k)` is the middle of eighth k.
  template <class F>
  explicit eighths(F place) {
    for (std::uint32_t k = 0; k < 8; ++k) {
      const vec3d p = place(k);
      x.v[k] = p.x;
      y.v[k] = p.y;
      z.v[k] = p.z;
    }
    middle = 0.5 * ((*this)[0] + (*this)[7]);
    for (const double along : {x.v[0] - middle.x, x.v[7] - middle.x, y.v[0] - middle.y, y.v[7] - middle.y,
                               z.v[0] - middle.z, z.v[7] - middle.z})
      apart = std::max(apart, std::fabs(along));
  }
  vec3d operator[](int k) const { return {x.v[k], y.v[k], z.v[k]}; }
};

}  // namespace clearance
