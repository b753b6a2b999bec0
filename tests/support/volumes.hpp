// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Two volumes that the library does not know: one fits its concept by members, one is a type that nobody can change.

#include <clearance/concepts.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace testing {

using clearance::ball, clearance::infinity, clearance::real, clearance::vec3;

/// A 14-DOP: slabs along the axes and the space diagonals.
struct kdop14 {
  vec3 center;
  real low[7], high[7];

  CLEARANCE_HD static vec3 along(int k) {
    constexpr real d = 0.57735026f;
    const real y = k & 1 ? -d : d, z = k & 2 ? -d : d;
    return k < 3 ? vec3{real(k == 0), real(k == 1), real(k == 2)} : vec3{d, y, z};
  }
  static kdop14 fit(std::span<const ball> balls) {
    kdop14 v;
    v.center = balls[0].center;
    for (int k = 0; k < 7; ++k) {
      const vec3 n = along(k);
      double low = infinity, high = -infinity, size = 0;
      for (const ball& b : balls) {
        const double dx = double(b.center.x) - v.center.x, dy = double(b.center.y) - v.center.y,
                     dz = double(b.center.z) - v.center.z;
        const double t = n.x * dx + n.y * dy + n.z * dz;
        low = std::min(low, t - b.radius);
        high = std::max(high, t + b.radius);
        size = std::max(size, std::abs(dx) + std::abs(dy) + std::abs(dz) + b.radius);
      }
      v.low[k] = clearance::rounded_down(low - 2.0 * clearance::slack * size);
      v.high[k] = clearance::rounded_up(high + 2.0 * clearance::slack * size);
    }
    return v;
  }
  CLEARANCE_HD real lower_bound(vec3 q) const {
    const vec3 d = q - center;
    real most = -infinity;
    for (int k = 0; k < 7; ++k) {
      const real t = clearance::dot(along(k), d);
      most = clearance::max(most, clearance::max(low[k] - t, t - high[k]));
    }
    return clearance::lowered(most, clearance::absolute(d.x) + clearance::absolute(d.y) + clearance::absolute(d.z));
  }
};
static_assert(clearance::bounding_volume<kdop14>);

}  // namespace testing

/// A foreign type, taught to the library from outside.
template <>
struct clearance::bounding_volume_traits<Eigen::AlignedBox3f> {
  /// Eigen declares copy constructors, but copying the bytes works.
  static constexpr bool bitwise_copyable = true;

  static Eigen::AlignedBox3f fit(std::span<const ball> balls) {
    Eigen::AlignedBox3d box;
    for (const ball& b : balls) {
      const Eigen::Vector3d c(b.center.x, b.center.y, b.center.z), r = Eigen::Vector3d::Constant(b.radius);
      box.extend(c - r);
      box.extend(c + r);
    }
    const double margin = 2.0 * slack * box.diagonal().norm();
    Eigen::AlignedBox3f rounded;
    for (int k = 0; k < 3; ++k) {
      rounded.min()[k] = std::nextafter(real(box.min()[k] - margin), -infinity);
      rounded.max()[k] = std::nextafter(real(box.max()[k] + margin), infinity);
    }
    return rounded;
  }
  CLEARANCE_HD static real lower_bound(const Eigen::AlignedBox3f& box, vec3 q) {
    const Eigen::Array3f p(q.x, q.y, q.z);
    const Eigen::Array3f beyond = (box.min().array() - p).max(p - box.max().array());
    const real deepest = beyond.maxCoeff();
    return deepest < 0 ? deepest * (1 + slack) : beyond.max(0.0f).matrix().norm() * (1 - slack);
  }
};
