// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points in double, on host and device.

#include <clearance/ground/config.hpp>

#include <Eigen/Core>

#include <cmath>

namespace clearance {

/// A point in double that device code may use, unlike Eigen's; converts from those and to them.
struct vec3d {
  double x = 0, y = 0, z = 0;

  vec3d() = default;
  CLEARANCE_HD constexpr vec3d(double x, double y, double z) : x(x), y(y), z(z) {}
  vec3d(const Eigen::Vector3d& v) : x(v.x()), y(v.y()), z(v.z()) {}
  operator Eigen::Vector3d() const { return {x, y, z}; }

  CLEARANCE_HD friend constexpr vec3d operator+(const vec3d& a, const vec3d& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  CLEARANCE_HD friend constexpr vec3d operator-(const vec3d& a, const vec3d& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  CLEARANCE_HD friend constexpr vec3d operator*(double s, const vec3d& a) { return {s * a.x, s * a.y, s * a.z}; }
  CLEARANCE_HD constexpr double dot(const vec3d& b) const { return x * b.x + y * b.y + z * b.z; }
  CLEARANCE_HD constexpr vec3d cross(const vec3d& b) const {
    return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x};
  }
  CLEARANCE_HD double norm() const { return ::sqrt(dot(*this)); }
};

}  // namespace clearance
