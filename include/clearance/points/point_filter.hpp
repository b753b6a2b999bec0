// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points of a cloud are valid, and why others are not. Depth images have the same rules for their pixels.

#include <clearance/concepts.hpp>

namespace clearance {

/// Which points of a cloud are valid: metres from `sensor` (a position in the cloud's own frame), both limits included.
struct point_filter {
  real nearest = 0, farthest = infinity;
  vec3 sensor = {0, 0, 0};
  bool zero_is_missing = false;  ///< Some lidars write their own position if nothing came back.

  /// Is only finiteness tested? That is the same for all points, so a kernel asks once.
  CLEARANCE_HD bool plain() const { return !zero_is_missing && !(nearest > 0) && !(farthest < infinity); }

  /// See `rounding_of`.
  void check() const {
    detail::check_range(nearest, farthest, "a cloud");
    if (!is_finite(sensor)) detail::refuse_source("a cloud's sensor is at a place that is not finite");
  }

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

  /// How far a position is from the nearest one within the limits, in metres; 0 if it is within.
  CLEARANCE_HD real beyond(vec3 p) const {
    const real away = length(p - sensor);
    return max(max(nearest - away, away - farthest), 0);
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

/// How far a position's z is from the limits of depth, in metres; 0 if it is within.
CLEARANCE_HD inline real beyond_depths(vec3 p, real nearest, real farthest) {
  return max(max(nearest - p.z, p.z - farthest), 0);
}

namespace detail {

/// What depth images have in common.
inline void check_image(const void* pixels, std::uint32_t width, std::uint32_t height, std::uint32_t row, real scale,
                        real nearest, real farthest) {
  const auto refuse = [&](const std::string& why) {  // text is made only here: a frame's check takes no memory
    refuse_source("a depth image of " + std::to_string(width) + " x " + std::to_string(height) + " pixels " + why);
  };
  if (pixels == nullptr) refuse("has none: they are null");
  if (row < width && height > 1)
    refuse("has rows that begin " + std::to_string(row) + " pixels apart, inside one another");
  if (!(scale > 0 && scale < infinity))
    refuse("has a scale of " + std::to_string(scale) + " m, which must be above 0 and finite");
  check_range(nearest, farthest, "a depth image");
}

}  // namespace detail

}  // namespace clearance
