// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The principal axis of a few numbers. It is written out, because Eigen's solver takes compilers longer to read and to
// instantiate than all else that builds a tree.

#include <clearance/ground/math.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace clearance::splits {

/// Sums in the order of Eigen's reductions: a tree that was built by Eigen's operators is built again, to the bit.
inline float sum_of(float x, float y, float z) { return x + (y + z); }
inline float plain_dot(vec3 a, vec3 b) { return sum_of(a.x * b.x, a.y * b.y, a.z * b.z); }
inline vec3 plain_cross(vec3 a, vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline vec3 times(float s, vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline vec3 over(vec3 a, float s) { return {a.x / s, a.y / s, a.z / s}; }
inline float plain_length(vec3 a) { return std::sqrt(plain_dot(a, a)); }
inline bool all_finite(vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// A symmetric matrix.
struct symmetric {
  float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  void add_square(vec3 a) {
    xx += a.x * a.x, xy += a.x * a.y, xz += a.x * a.z, yy += a.y * a.y, yz += a.y * a.z, zz += a.z * a.z;
  }
  symmetric less(float of_diagonal) const { return {xx - of_diagonal, xy, xz, yy - of_diagonal, yz, zz - of_diagonal}; }
  vec3 column(int k) const { return k == 0 ? vec3{xx, xy, xz} : (k == 1 ? vec3{xy, yy, yz} : vec3{xz, yz, zz}); }
};

/// The eigenvalues, ascending, by the roots of the characteristic polynomial. Its trace should be near 0, and its
/// largest entry 1.
inline void eigenvalues(const symmetric& m, float (&roots)[3]) {
  constexpr float third = 1.0f / 3.0f;
  const float root_of_3 = std::sqrt(3.0f);
  const float c0 =
      m.xx * m.yy * m.zz + 2.0f * m.xy * m.xz * m.yz - m.xx * m.yz * m.yz - m.yy * m.xz * m.xz - m.zz * m.xy * m.xy;
  const float c1 = m.xx * m.yy - m.xy * m.xy + m.xx * m.zz - m.xz * m.xz + m.yy * m.zz - m.yz * m.yz;
  const float c2 = m.xx + m.yy + m.zz;
  const float mean = c2 * third;
  const float a = std::max((c2 * mean - c1) * third, 0.0f);
  const float half_b = 0.5f * (c0 + mean * (2.0f * mean * mean - c1));
  const float q = std::max(a * a * a - half_b * half_b, 0.0f);
  const float rho = std::sqrt(a), theta = std::atan2(std::sqrt(q), half_b) * third;
  const float cosine = std::cos(theta), sine = std::sin(theta);
  roots[0] = mean - rho * (cosine + root_of_3 * sine);
  roots[1] = mean - rho * (cosine - root_of_3 * sine);
  roots[2] = mean + 2.0f * rho * cosine;
}

/// The unit vector that a matrix of rank 2 maps to 0; and a vector across it, a column of the matrix.
struct kernel_of {
  vec3 direction, across;

  explicit kernel_of(const symmetric& m) {
    const float diagonal[3] = {std::abs(m.xx), std::abs(m.yy), std::abs(m.zz)};
    int k = 0;
    for (int i = 1; i < 3; ++i)
      if (diagonal[i] > diagonal[k]) k = i;
    across = m.column(k);
    const vec3 a = plain_cross(across, m.column((k + 1) % 3)), b = plain_cross(across, m.column((k + 2) % 3));
    const float of_a = plain_dot(a, a), of_b = plain_dot(b, b);
    direction = of_a > of_b ? over(a, std::sqrt(of_a)) : over(b, std::sqrt(of_b));
  }
};

/// The unit eigenvector of the largest eigenvalue, in closed form, as Eigen 3.4's `computeDirect` finds it. Not finite
/// if the matrix is not.
inline vec3 largest_axis(const symmetric& m) {
  constexpr float epsilon = std::numeric_limits<float>::epsilon();
  symmetric s = m.less(sum_of(m.xx, m.yy, m.zz) / 3.0f);
  const float scale =
      std::max({std::abs(s.xx), std::abs(s.xy), std::abs(s.xz), std::abs(s.yy), std::abs(s.yz), std::abs(s.zz)});
  if (scale > 0) s = {s.xx / scale, s.xy / scale, s.xz / scale, s.yy / scale, s.yz / scale, s.zz / scale};
  float roots[3];
  eigenvalues(s, roots);
  if (roots[2] - roots[0] <= epsilon) return {0, 0, 1};  // all three are one
  const float above = roots[2] - roots[1], below = roots[1] - roots[0];
  if (above > below) return kernel_of(s.less(roots[2])).direction;
  const kernel_of first(s.less(roots[0]));
  if (!(above <= 2 * epsilon * below)) return kernel_of(s.less(roots[2])).direction;
  // The other two eigenvalues are one: any vector across the first will do.
  const vec3 v = first.across - times(plain_dot(first.direction, first.across), first.across);
  const float square = plain_dot(v, v);
  return square > 0 ? over(v, std::sqrt(square)) : v;
}

}  // namespace clearance::splits
