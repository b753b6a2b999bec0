// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Boxes that are turned to fit what they enclose, as the volumes of a tree.

#include <clearance/concepts.hpp>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

namespace clearance {

/// Oriented box: a centre, three unit axes and the half extent along each.
struct obb {
  vec3 center;
  vec3 axis[3];
  real half[3];

  /// Axes are the principal directions of the ball centres, or the coordinate axes where those give a smaller box.
  /// Any frame is valid: the extents are measured along the float axes, in double, and rounded outward.
  static obb fit(std::span<const ball> balls) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const ball& b : balls) mean += Eigen::Vector3d(b.center.x, b.center.y, b.center.z) / double(balls.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const ball& b : balls) {
      const Eigen::Vector3d d = Eigen::Vector3d(b.center.x, b.center.y, b.center.z) - mean;
      covariance += d * d.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    const obb straight = along(Eigen::Matrix3d::Identity(), balls);
    if (solver.info() != Eigen::Success || !solver.eigenvectors().allFinite()) return straight;
    const obb turned = along(solver.eigenvectors(), balls);
    return turned.area() < straight.area() ? turned : straight;
  }

  CLEARANCE_HD real lower_bound(vec3 q) const {
    const vec3 d = q - center;
    const vec3 beyond{absolute(dot(axis[0], d)) - half[0], absolute(dot(axis[1], d)) - half[1],
                      absolute(dot(axis[2], d)) - half[2]};
    const real deepest = max(max(beyond.x, beyond.y), beyond.z);
    if (deepest < 0) return deepest * (1 + slack);
    // The axes are orthonormal to 1e-7 only; the factor covers that too.
    return rough_length({max(beyond.x, 0), max(beyond.y, 0), max(beyond.z, 0)}) * (1 - slack) -
           slack * absolute(deepest);
  }

  /// Outside along the way from the box. Inside along the axis of the nearest face.
  CLEARANCE_HD tangent tangent_at(vec3 q) const {
    const vec3 d = q - center, local{dot(axis[0], d), dot(axis[1], d), dot(axis[2], d)};
    const box_sides sides{{absolute(local.x) - half[0], absolute(local.y) - half[1], absolute(local.z) - half[2]},
                          {choice(local.x < 0, -1, 1), choice(local.y < 0, -1, 1), choice(local.z < 0, -1, 1)}};
    const tangent t = sides.tangent_of_box();
    // The axes are orthonormal to 1e-7 only.
    return {t.distance - slack * absolute(t.distance),
            fma(t.direction.x, axis[0], fma(t.direction.y, axis[1], scaled(t.direction.z, axis[2])))};
  }

  /// Outside it measures from the box. Inside it is true for any reach but minus infinity.
  CLEARANCE_HD bool may_reach(vec3 q, real reach) const {
    const vec3 d = q - center;
    const vec3 beyond{positive_part(absolute(dot(axis[0], d)) - half[0]),
                      positive_part(absolute(dot(axis[1], d)) - half[1]),
                      positive_part(absolute(dot(axis[2], d)) - half[2])};
    return beyond.x * beyond.x + beyond.y * beyond.y + beyond.z * beyond.z <= square_of_reach(reach);
  }

  /// A corner is rounded where it is, which may be far from the origin.
  std::array<ball, 8> balls() const {
    const real off = slack * (half[0] + half[1] + half[2]) +
                     0x1p-22f * (absolute(center.x) + absolute(center.y) + absolute(center.z));
    std::array<ball, 8> corners;
    for (int k = 0; k < 8; ++k) {
      vec3 p = center;
      for (int a = 0; a < 3; ++a) p = fma(k >> a & 1 ? half[a] : -half[a], axis[a], p);
      corners[k] = {p, off};
    }
    return corners;
  }

 private:
  static obb along(const Eigen::Matrix3d& frame, std::span<const ball> balls) {
    obb box;
    Eigen::Matrix3d axes;
    for (int k = 0; k < 3; ++k) {
      box.axis[k] = {to_float(frame(0, k)), to_float(frame(1, k)), to_float(frame(2, k))};
      axes.row(k) << box.axis[k].x, box.axis[k].y, box.axis[k].z;
    }
    // Measured from a near float: far from the origin, even doubles would lose the size of something tiny.
    const Eigen::Vector3d near(balls[0].center.x, balls[0].center.y, balls[0].center.z);
    Eigen::Vector3d lo = Eigen::Vector3d::Constant(infinity), hi = -lo;
    for (const ball& b : balls) {
      const Eigen::Vector3d t = axes * (Eigen::Vector3d(b.center.x, b.center.y, b.center.z) - near);
      const double r = b.radius * (1 + 1e-6);  // the axes' length is 1 to 1e-7 only
      lo = lo.cwiseMin((t.array() - r).matrix());
      hi = hi.cwiseMax((t.array() + r).matrix());
    }
    const Eigen::Vector3d middle = near + axes.inverse() * ((lo + hi) / 2);
    box.center = {to_float(middle.x()), to_float(middle.y()), to_float(middle.z())};
    const Eigen::Vector3d at = axes * (Eigen::Vector3d(box.center.x, box.center.y, box.center.z) - near);
    const double margin = 2.0 * slack * (hi - lo).norm() + vanishing;
    for (int k = 0; k < 3; ++k)
      box.half[k] = std::nextafter(real(std::max(hi[k] - at[k], at[k] - lo[k]) + margin), infinity);
    return box;
  }
  real area() const { return half[0] * half[1] + half[1] * half[2] + half[2] * half[0]; }
};

static_assert(bounding_volume<obb>);

}  // namespace clearance
