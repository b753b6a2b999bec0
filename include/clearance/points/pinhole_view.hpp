// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a camera can see at all, whatever is there.

#include <clearance/points/depth_image.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
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

  /// Which of 64 places in a ball it shows, one bit each. `center` and `radius` in a part's frame, metres.
  std::uint64_t shows_of_ball(vec3 center, double radius, const Eigen::Isometry3d& camera_from_part) const {
    static const auto places = [] {  // equal shares of the volume, turned by the golden angle
      std::array<Eigen::Vector3d, 64> all;
      for (int i = 0; i < 64; ++i) {
        const double away = std::cbrt((i * 37 % 64 + 0.5) / 64), up = 1 - (2 * i + 1) / 64.0,
                     turn = 2.399963229728653 * i, beside = std::sqrt(1 - up * up);
        all[std::size_t(i)] = away * Eigen::Vector3d(beside * std::cos(turn), beside * std::sin(turn), up);
      }
      return all;
    }();
    std::uint64_t bits = 0;
    for (int i = 0; i < 64; ++i) {
      const Eigen::Vector3d at =
          camera_from_part * (Eigen::Vector3d(center.x, center.y, center.z) + radius * places[std::size_t(i)]);
      bits |= std::uint64_t(shows(at.x(), at.y(), at.z())) << i;
    }
    return bits;
  }
};

}  // namespace clearance
