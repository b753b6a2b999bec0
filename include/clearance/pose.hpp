// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From double poses on the host to what a kernel needs of them.

#include <clearance/math.hpp>

#include <Eigen/Geometry>

#include <stdexcept>
#include <string>

namespace clearance {

/// Returns `pose` with its rotation made orthonormal to double precision. Throws if it is not rigid to 1e-4: scale, shear,
/// a reflection, or a number that is not finite. `what` and `number` say in the message which pose it was.
inline Eigen::Isometry3d rigid(const Eigen::Isometry3d& pose, const char* what = "pose", std::int64_t number = -1) {
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("clearance: the pose of " + std::string(what) + (number < 0 ? "" : " " + std::to_string(number)) + " is not rigid: " + why);
  };
  const Eigen::Matrix3d r = pose.linear();
  if (!pose.matrix().allFinite()) refuse("it has a number that is not finite");
  const double skew = (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (skew > 1e-4) refuse("its axes deviate from orthonormal by " + std::to_string(skew));
  if (r.determinant() < 0) refuse("it is a reflection");
  if (skew < 1e-14) return pose;
  Eigen::Isometry3d clean = Eigen::Isometry3d::Identity();
  clean.linear() = Eigen::Quaterniond(r).normalized().toRotationMatrix();
  clean.translation() = pose.translation();
  return clean;
}

/// The nearest float transform, for the exact path of a query.
inline rigid_transform to_floats(const Eigen::Isometry3d& pose) {
  rigid_transform t;
  for (int k = 0; k < 3; ++k) t.row[k] = {real(pose(k, 0)), real(pose(k, 1)), real(pose(k, 2))};
  t.translation = {real(pose(0, 3)), real(pose(1, 3)), real(pose(2, 3))};
  return t;
}

/// A point in world coordinates: double, because a world may be far from its origin.
struct position {
  double x, y, z;
};

/// world-from-something in double, as plain data for a kernel.
class world_transform {
 public:
  world_transform() = default;
  explicit world_transform(const Eigen::Isometry3d& pose) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) m[r][c] = pose(r, c);
  }

  CLEARANCE_HD position operator()(vec3 p) const {
    return {along(0, p, m[0][3]), along(1, p, m[1][3]), along(2, p, m[2][3])};
  }
  CLEARANCE_HD vec3 turned(vec3 v) const {
    return {real(along(0, v, 0)), real(along(1, v, 0)), real(along(2, v, 0))};
  }

 private:
  CLEARANCE_HD double along(int k, vec3 p, double offset) const {
    return fma(m[k][0], double(p.x), fma(m[k][1], double(p.y), fma(m[k][2], double(p.z), offset)));
  }

  double m[3][4];
};

}  // namespace clearance
