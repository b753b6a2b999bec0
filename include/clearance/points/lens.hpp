// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where a lens shows a ray, and which ray it shows at a place. In double, on the host, once for each camera.

#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace clearance {

/// A direction or a place in an image: x and y at z = 1, in the camera's frame.
struct at_one {
  double x, y;
};

/// OpenCV's lens: `k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4` (radial, tangential, rational, thin prism); the rest is 0.
struct brown_lens {
  std::array<double, 12> d{};

  /// Where a ray is seen, how that changes with it, and whether it keeps its orientation there.
  struct seen {
    double x, y, x_by_x, x_by_y, y_by_x, y_by_y;
    bool unfolded;
  };
  seen look(at_one ray) const {
    const auto [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4] = d;
    const auto [x, y] = ray;
    const double r = x * x + y * y, under = 1 + r * (k4 + r * (k5 + r * k6));
    const double radial = (1 + r * (k1 + r * (k2 + r * k3))) / under;
    const double slope = (k1 + r * (2 * k2 + 3 * r * k3) - radial * (k4 + r * (2 * k5 + 3 * r * k6))) / under;
    const double prism_x = 2 * (s1 + 2 * r * s2), prism_y = 2 * (s3 + 2 * r * s4);
    const double across = 2 * (x * y * slope + p1 * x + p2 * y);
    seen s{x * radial + 2 * p1 * x * y + p2 * (r + 2 * x * x) + r * (s1 + r * s2),
           y * radial + 2 * p2 * x * y + p1 * (r + 2 * y * y) + r * (s3 + r * s4),
           radial + 2 * x * x * slope + 2 * p1 * y + 6 * p2 * x + x * prism_x,
           across + y * prism_x,
           across + x * prism_y,
           radial + 2 * y * y * slope + 6 * p1 * y + 2 * p2 * x + y * prism_y,
           false};
    s.unfolded = under > 0 && s.x_by_x * s.y_by_y - s.x_by_y * s.y_by_x > 0;
    return s;
  }
  at_one project(at_one ray) const {
    const seen s = look(ray);
    return {s.x, s.y};
  }

  /// The ray that is seen there: by Newton's method, with steps that are shortened until they help. None if that does
  /// not converge, or if the lens folds between the centre and the ray: then the place shows several rays.
  std::optional<at_one> unproject(at_one place) const {
    const auto off = [&](const seen& s) { return std::hypot(s.x - place.x, s.y - place.y); };
    at_one ray = place;
    seen s = look(ray);
    for (int turns = 0; turns < 100; ++turns) {
      const double turn = s.x_by_x * s.y_by_y - s.x_by_y * s.y_by_x, ex = s.x - place.x, ey = s.y - place.y;
      const double dx = (s.y_by_y * ex - s.x_by_y * ey) / turn, dy = (s.x_by_x * ey - s.y_by_x * ex) / turn;
      if (std::hypot(dx, dy) <= 1e-11 * (1 + std::hypot(ray.x, ray.y))) return reached(ray);
      const double before = off(s);
      double share = 1;
      for (; share > 1e-4; share /= 2) {
        const at_one next{ray.x - share * dx, ray.y - share * dy};
        const seen there = look(next);
        if (!(off(there) < before)) continue;
        ray = next, s = there;
        break;
      }
      if (!(share > 1e-4)) return {};
    }
    return {};
  }

 private:
  std::optional<at_one> reached(at_one ray) const {
    constexpr int samples = 64;
    for (int k = samples; k > 0; --k)
      if (!look({ray.x * k / samples, ray.y * k / samples}).unfolded) return {};
    return ray;
  }
};

/// OpenCV's fisheye lens (ROS: equidistant): a ray at an angle a from the axis is seen a (1 + k1 a^2 + ... + k4 a^8)
/// from the centre.
class fisheye_lens {
 public:
  /// Wider rays have none: depth along the axis says nothing about them.
  static constexpr double widest = 1.55;

  explicit fisheye_lens(const std::array<double, 4>& k) : k_(k) {
    constexpr int samples = 4096;
    for (int n = 1; n <= samples && slope(widest * n / samples) > 0; ++n) limit_ = widest * n / samples;
  }

  at_one project(at_one ray) const {
    const double r = std::hypot(ray.x, ray.y), by = r > 0 ? radius(std::atan(r)) / r : 1;
    return {ray.x * by, ray.y * by};
  }
  /// None where the ray would be too wide, or beyond where the lens folds.
  std::optional<at_one> unproject(at_one place) const {
    const double r = std::hypot(place.x, place.y);
    if (!(r <= radius(limit_))) return {};
    double low = 0, high = limit_, angle = std::fmin(r, limit_);
    for (int turns = 0; turns < 200 && high - low > 0; ++turns) {  // between the two the radius grows
      const double off = radius(angle) - r;
      (off > 0 ? high : low) = angle;
      double next = angle - off / slope(angle);
      if (!(next > low && next < high)) next = low + (high - low) / 2;
      if (off == 0 || std::fabs(next - angle) <= 4e-16 * angle) break;
      angle = next;
    }
    const double by = r > 0 ? std::tan(angle) / r : 1;
    return at_one{place.x * by, place.y * by};
  }

 private:
  double radius(double a) const {
    const double s = a * a;
    return a * (1 + s * (k_[0] + s * (k_[1] + s * (k_[2] + s * k_[3]))));
  }
  double slope(double a) const {
    const double s = a * a;
    return 1 + s * (3 * k_[0] + s * (5 * k_[1] + s * (7 * k_[2] + s * 9 * k_[3])));
  }

  std::array<double, 4> k_;
  double limit_ = 0;  // up to here the radius grows with the angle
};

}  // namespace clearance
