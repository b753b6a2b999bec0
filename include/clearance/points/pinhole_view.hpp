// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a camera can see at all, whatever is there.

#include <clearance/points/depth_image.hpp>

#include <algorithm>
#include <cmath>

namespace clearance {

/// The room that a pinhole image shows, between two depths (metres of z): a pyramid without its tip.
struct pinhole_view {
  double left, right, top, bottom;  ///< The image's edges at z = 1, pixels' own halves included.
  double nearest, farthest;

  template <class Pixel>
  pinhole_view(const depth_image<Pixel>& image, double nearest, double farthest)
      : left((-0.5 - image.cx) * image.inverse_fx),
        right((image.width - 0.5 - image.cx) * image.inverse_fx),
        top((-0.5 - image.cy) * image.inverse_fy),
        bottom((image.height - 0.5 - image.cy) * image.inverse_fy),
        nearest(nearest),
        farthest(farthest) {}

  bool shows(double x, double y, double z) const {
    return z >= nearest && z <= farthest && x >= left * z && x <= right * z && y >= top * z && y <= bottom * z;
  }
  /// How far everything in a ball is at least from all that is not shown; 0 or less if some of the ball is not. The
  /// camera's frame, metres.
  double from_edge(const ball& b) const {
    const double x = b.center.x, y = b.center.y, z = b.center.z;
    const auto inward = [&](double across, double slope, double sign) {
      return sign * (slope * z - across) / std::hypot(1, slope);
    };
    const double least = std::min({inward(x, left, -1), inward(x, right, 1), inward(y, top, -1), inward(y, bottom, 1),
                                   z - nearest, farthest - z});
    return least - b.radius - 1e-6 * (std::fabs(x) + std::fabs(y) + std::fabs(z));
  }
};

}  // namespace clearance
