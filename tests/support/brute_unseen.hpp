// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a camera hides, by definition: behind each pixel the part of its pyramid between two depths. How far that is
// from primitives, in double, by corners, edges and faces.

#include "support/random.hpp"

#include <clearance/points/hidden.hpp>

#include <algorithm>
#include <array>
#include <optional>

namespace testing {

using place = Eigen::Vector3d;

inline place doubles(vec3 p) { return {p.x, p.y, p.z}; }

inline double to_segment(const place& p, const place& a, const place& b) {
  const place e = b - a;
  const double square = e.squaredNorm();
  return (p - a - (square > 0 ? std::clamp((p - a).dot(e) / square, 0.0, 1.0) : 0.0) * e).norm();
}

/// Between two segments: at an end of one of them, or where the lines are nearest.
inline double between_segments(const place& a, const place& b, const place& c, const place& d) {
  double least = std::min({to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b)});
  const place e = b - a, f = d - c, normal = e.cross(f);
  const double square = normal.squaredNorm();
  if (square > 0) {
    const double s = (c - a).cross(f).dot(normal) / square, t = (c - a).cross(e).dot(normal) / square;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) least = std::min(least, (a + s * e - c - t * f).norm());
  }
  return least;
}

/// To a flat polygon without dents: its sides, or its plane if the point is over it.
template <std::size_t N>
double to_polygon(const place& p, const std::array<place, N>& corners) {
  double least = clearance::infinity;
  place normal(0, 0, 0);
  for (std::size_t k = 0; k < N; ++k) {
    least = std::min(least, to_segment(p, corners[k], corners[(k + 1) % N]));
    normal += corners[k].cross(corners[(k + 1) % N]);
  }
  const double size = normal.norm();
  if (!(size > 0)) return least;
  for (std::size_t k = 0; k < N; ++k)
    if (normal.dot((corners[(k + 1) % N] - corners[k]).cross(p - corners[k])) < 0) return least;
  return std::min(least, std::abs(normal.dot(p - corners[0])) / size);
}

/// The room of a pixel between two depths.
struct pyramid {
  std::array<place, 8> corners;  ///< Four near ones and four far ones, in the same order around.
  std::array<std::array<place, 4>, 6> faces;
  std::array<std::array<double, 4>, 6> planes;  ///< n.p <= w inside.

  /// The edges are the pixel's at z = 1; z in metres.
  pyramid(double left, double right, double top, double bottom, double from, double to) {
    const double x[] = {left, right, right, left}, y[] = {top, top, bottom, bottom};
    for (std::size_t k = 0; k < 4; ++k)
      corners[k] = {x[k] * from, y[k] * from, from}, corners[k + 4] = {x[k] * to, y[k] * to, to};
    faces[0] = {corners[0], corners[1], corners[2], corners[3]};
    faces[1] = {corners[4], corners[5], corners[6], corners[7]};
    for (std::size_t k = 0; k < 4; ++k)
      faces[k + 2] = {corners[k], corners[(k + 1) % 4], corners[(k + 1) % 4 + 4], corners[k + 4]};
    planes = {
        {{0, 0, -1, -from}, {0, 0, 1, to}, {0, -1, top, 0}, {1, 0, -right, 0}, {0, 1, -bottom, 0}, {-1, 0, left, 0}}};
  }

  double over(std::size_t plane, const place& p) const {
    const auto& n = planes[plane];
    return n[0] * p.x() + n[1] * p.y() + n[2] * p.z() - n[3];
  }
  bool contains(const place& p) const {
    for (std::size_t k = 0; k < 6; ++k)
      if (over(k, p) > 0) return false;
    return true;
  }
  double distance(const place& p) const {
    if (contains(p)) return 0;
    double least = clearance::infinity;
    for (const auto& face : faces) least = std::min(least, to_polygon(p, face));
    return least;
  }
  double distance(const std::array<place, 3>& t) const {
    std::vector<place> left(t.begin(), t.end());  // of the triangle, after each plane
    for (std::size_t k = 0; k < 6; ++k) {
      std::vector<place> next;
      for (std::size_t i = 0; i < left.size(); ++i) {
        const place &a = left[i], &b = left[(i + 1) % left.size()];
        const double x = over(k, a), y = over(k, b);
        if (x <= 0) next.push_back(a);
        if ((x < 0 && y > 0) || (x > 0 && y < 0)) next.push_back(a + x / (x - y) * (b - a));
      }
      left = std::move(next);
    }
    if (!left.empty()) return 0;
    double least = clearance::infinity;
    for (std::size_t k = 0; k < 3; ++k) {
      least = std::min(least, distance(t[k]));
      for (const auto& face : faces)
        for (std::size_t i = 0; i < 4; ++i)
          least = std::min(least, between_segments(t[k], t[(k + 1) % 3], face[i], face[(i + 1) % 4]));
    }
    for (const place& corner : corners) least = std::min(least, to_polygon(corner, t));
    return least;
  }
};

inline double to_pyramid(const inner_sphere& s, const Eigen::Isometry3d& to, const pyramid& room) {
  return room.distance(to * doubles(s.center)) - s.radius;
}
inline double to_pyramid(const triangle& t, const Eigen::Isometry3d& to, const pyramid& room) {
  return room.distance(std::array{place(to * doubles(t.a)), place(to * doubles(t.b)), place(to * doubles(t.c))});
}

/// From which depth on a pixel hides what is behind it, if it does.
struct pixel_rule {
  double nearest = 0, farthest = clearance::infinity;  ///< The sensor's range.
  bool minus_infinity_is_near = true;
  clearance::hiding room;

  /// `raw` is what the pixel holds, in its unit. `own`: the robot's.
  std::optional<double> hides_from(double raw, double scale, bool sixteen_bits, bool own, bool own_shadow) const {
    const double z = raw * scale;
    const bool measured =
        std::isfinite(raw) && raw != 0 && !(sixteen_bits && raw == 65535) && z >= nearest && z <= farthest;
    if ((measured && own) != own_shadow) return {};
    double from = room.nearest;
    if (measured) {
      from = z;
    } else if (raw == -double(clearance::infinity)) {
      if (minus_infinity_is_near) from = 0;
    } else if (raw == double(clearance::infinity)) {
      if (room.infinite_is_free) return {};
    } else if (std::isfinite(raw) && raw > 0 && !(sixteen_bits && raw == 65535)) {
      from = std::min(z, from);
    }
    return from < room.farthest ? std::optional(from) : std::nullopt;
  }
};

}  // namespace testing
