// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/concepts.hpp>

namespace clearance {

/// Which points of a cloud are valid: metres from `sensor` (a position in the cloud's own frame), both limits included.
struct point_filter {
  real nearest = 0, farthest = infinity;
  vec3 sensor = {0, 0, 0};
  bool zero_is_missing = false;  ///< Some lidars write their own position if nothing came back.

  /// Only finiteness is tested. The same for all points, so a kernel asks once.
  CLEARANCE_HD bool plain() const { return !zero_is_missing && !(nearest > 0) && !(farthest < infinity); }

  CLEARANCE_HD sample operator()(vec3 p) const {
    if (!is_finite(p)) return {p, drop_reason::not_finite};
    if (plain()) return {p, drop_reason::none};
    if (zero_is_missing && p == sensor) return {p, drop_reason::missing};
    if (nearest > 0 || farthest < infinity) {
      const real away = length(p - sensor);
      if (!(away >= nearest && away <= farthest)) return {p, drop_reason::out_of_range};
    }
    return {p, drop_reason::none};
  }

  /// Filters four points, x y z one after another. Writes their positions and returns their drop reasons, one per byte.
  CLEARANCE_HD unsigned look(const real (&f)[12], vec3 (&out)[4]) const {
    bool told = plain();
    unsigned reasons = 0;
    CLEARANCE_UNROLL
    for (int j = 0; j < 4; ++j) {
      out[j] = {f[3 * j], f[3 * j + 1], f[3 * j + 2]};
      const real square = dot(out[j], out[j]);  // a kernel needs it, too; NaN if a coordinate is NaN
      told &= !(square >= 0x1p116f);            // all are finite
      reasons |= unsigned(square == square ? drop_reason::none : drop_reason::not_finite) << 8 * j;
    }
    if (told) return reasons;
    reasons = 0;
    CLEARANCE_UNROLL
    for (int j = 0; j < 4; ++j) reasons |= unsigned((*this)(out[j]).dropped) << 8 * j;
    return reasons;
  }
};

/// The sample of a pixel that holds `d`, if its point is `p`: 0 is missing, 65535 in 16 bits saturated; z is bounded,
/// metres.
template <class Pixel>
CLEARANCE_HD sample depth_sample(Pixel d, vec3 p, real nearest, real farthest, bool minus_infinity_is_near) {
  if (d == 0) return {p, drop_reason::missing};
  if constexpr (std::is_same_v<Pixel, std::uint16_t>) {
    if (d == 65535) return {p, drop_reason::saturated};
  }
  if (!is_finite(p)) {
    if constexpr (std::is_same_v<Pixel, float>)
      if (minus_infinity_is_near && d == -infinity) return {p, drop_reason::too_close};
    return {p, drop_reason::not_finite};
  }
  if (!(p.z >= nearest && p.z <= farthest)) return {p, drop_reason::out_of_range};
  return {p, drop_reason::none};
}

}  // namespace clearance
