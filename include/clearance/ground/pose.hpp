// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From double poses on the host to the transforms that a kernel needs.

#include <clearance/ground/math.hpp>

#include <Eigen/Geometry>

#include <stdexcept>
#include <string>

namespace clearance {

/// A point in world coordinates, metres. Double, because points may be far from the world's origin.
struct position {
  double x, y, z;
};

/// A rigid transform in double as plain data, such as world-from-part. Kernels get or compose it. Its arithmetic is the
/// same everywhere.
struct world_transform {
  double m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};

  world_transform() = default;
  explicit world_transform(const Eigen::Isometry3d& pose) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) m[r][c] = pose(r, c);
  }

  CLEARANCE_HD position operator()(position p) const {
    return {along(0, p, m[0][3]), along(1, p, m[1][3]), along(2, p, m[2][3])};
  }
  CLEARANCE_HD position operator()(vec3 p) const { return (*this)(position{p.x, p.y, p.z}); }
  CLEARANCE_HD vec3 turned(vec3 v) const {
    const position p{v.x, v.y, v.z};
    return {real(along(0, p, 0)), real(along(1, p, 0)), real(along(2, p, 0))};
  }
  CLEARANCE_HD position translation() const { return {m[0][3], m[1][3], m[2][3]}; }

  CLEARANCE_HD friend world_transform operator*(const world_transform& a, const world_transform& b) {
    world_transform ab;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) ab.m[r][c] = a.along(r, {b.m[0][c], b.m[1][c], b.m[2][c]}, c == 3 ? a.m[r][3] : 0);
    return ab;
  }
  /// The inverse, if the rotation is orthonormal.
  CLEARANCE_HD world_transform inverse() const {
    world_transform t;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) t.m[r][c] = m[c][r];
    for (int r = 0; r < 3; ++r) t.m[r][3] = -t.along(r, translation(), 0);
    return t;
  }

 private:
  CLEARANCE_HD double along(int k, position p, double offset) const {
    return fma(m[k][0], p.x, fma(m[k][1], p.y, fma(m[k][2], p.z, offset)));
  }
};

inline Eigen::Isometry3d to_isometry(const world_transform& t) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) pose(r, c) = t.m[r][c];
  return pose;
}

/// How far the axes are from orthonormal. NaN or infinite if an entry of the pose is.
CLEARANCE_HD inline double skew(const world_transform& t) {
  double most = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      const double d =
          fma(t.m[0][i], t.m[0][j], fma(t.m[1][i], t.m[1][j], fma(t.m[2][i], t.m[2][j], i == j ? -1.0 : 0.0)));
      const double off = (d < 0 ? -d : d) + 0 * t.m[i][3];
      most = off > most || off != off ? off : most;
    }
  return most;
}
CLEARANCE_HD inline bool mirrors(const world_transform& t) {
  const auto minor = [&](int a, int b) { return fma(t.m[1][a], t.m[2][b], -(t.m[1][b] * t.m[2][a])); };
  return fma(t.m[0][0], minor(1, 2), fma(t.m[0][1], minor(2, 0), t.m[0][2] * minor(0, 1))) < 0;
}

inline constexpr double most_skew = 1e-4;

/// The limit of `is_finite` for points: beyond it, squares of float distances would overflow.
CLEARANCE_HD inline bool too_far(const world_transform& t) {
  const auto far = [](double x) { return !(-1e18 <= x && x <= 1e18); };
  return far(t.m[0][3]) || far(t.m[1][3]) || far(t.m[2][3]);
}

/// Makes the rotation orthonormal to double precision, by Newton's steps towards the closest one: R (3 - R'R) / 2.
/// False if the pose is not rigid to `most_skew` (scale, shear, reflection, a number that is not finite), or beyond
/// 1e18 m.
CLEARANCE_HD inline bool make_rigid(world_transform& t) {
  double off = skew(t);
  if (!(off <= most_skew) || mirrors(t) || too_far(t)) return false;
  for (int steps = 0; off >= 1e-14 && steps < 3; ++steps, off = skew(t)) {
    world_transform next = t;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        double sum = 0;  // of row r of R and column c of R'R - 1
        for (int k = 0; k < 3; ++k)
          sum =
              fma(t.m[r][k],
                  fma(t.m[0][k], t.m[0][c], fma(t.m[1][k], t.m[1][c], fma(t.m[2][k], t.m[2][c], k == c ? -1.0 : 0.0))),
                  sum);
        next.m[r][c] = fma(-0.5, sum, t.m[r][c]);
      }
    t = next;
  }
  return true;
}

namespace detail {

/// Throws std::invalid_argument, and says what is wrong with the pose. It is apart and cold, because callers are
/// compiled for several processors with all that they call.
[[noreturn, gnu::noinline, gnu::cold]] inline void refuse_pose(const Eigen::Isometry3d& pose, const world_transform& t,
                                                               const char* what, std::int64_t number) {
  bool finite = true;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) finite = finite && std::isfinite(pose(r, c));
  const std::string why = !finite               ? "it has a number that is not finite"
                          : too_far(t)          ? "it is farther from the origin than 1e18 m"
                          : skew(t) > most_skew ? "its axes deviate from orthonormal by " + std::to_string(skew(t))
                                                : "it is a reflection";
  throw std::invalid_argument("clearance: the pose of " + std::string(what) +
                              (number < 0 ? "" : " " + std::to_string(number)) + " is not rigid: " + why);
}

}  // namespace detail

/// `pose` with its rotation made orthonormal to double precision. Throws std::invalid_argument if it is not rigid to
/// 1e-4 (scale, shear, a reflection, a number that is not finite) or is beyond 1e18 m. `what` and `number` name the
/// pose in the message.
inline world_transform rigid_transform_of(const Eigen::Isometry3d& pose, const char* what = "pose",
                                          std::int64_t number = -1) {
  world_transform t(pose);
  if (!make_rigid(t)) detail::refuse_pose(pose, t, what, number);
  return t;
}
inline Eigen::Isometry3d rigid(const Eigen::Isometry3d& pose, const char* what = "pose", std::int64_t number = -1) {
  return to_isometry(rigid_transform_of(pose, what, number));
}

/// The nearest float transform, for the exact path of a query.
CLEARANCE_HD inline rigid_transform to_floats(const world_transform& t) {
  rigid_transform f;
  for (int k = 0; k < 3; ++k) f.row[k] = {real(t.m[k][0]), real(t.m[k][1]), real(t.m[k][2])};
  f.translation = {real(t.m[0][3]), real(t.m[1][3]), real(t.m[2][3])};
  return f;
}
inline rigid_transform to_floats(const Eigen::Isometry3d& pose) { return to_floats(world_transform(pose)); }

}  // namespace clearance
