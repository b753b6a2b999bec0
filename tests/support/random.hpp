// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/primitive/triangle.hpp>

#include <Eigen/Geometry>

#include <random>

namespace testing {

using clearance::ball, clearance::inner_sphere, clearance::real, clearance::triangle, clearance::vec3;

/// Random geometry, the same in every run, with every standard library and compiler: each number is drawn by a
/// statement or in braces, because arguments have no order, and no product meets a sum that could be fused with it.
class dice {
 public:
  explicit dice(unsigned seed) : engine_(seed) {}

  double uniform(double low, double high) { return std::fma(high - low, double(engine_()) / 4294967296.0, low); }
  unsigned below(unsigned n) { return unsigned(uniform(0, n)); }
  real number(double low, double high) { return real(uniform(low, high)); }
  /// In a cube around `center` with this half edge.
  vec3 point(double half, vec3 center = {0, 0, 0}) {
    return {number(-half, half) + center.x, number(-half, half) + center.y, number(-half, half) + center.z};
  }
  vec3 direction() {
    for (;;) {
      const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
      const double l = std::sqrt(std::fma(x, x, std::fma(y, y, z * z)));
      if (l > 0.1 && l < 1) return {real(x / l), real(y / l), real(z / l)};
    }
  }
  Eigen::Isometry3d pose(double half) {
    const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1), w = uniform(0.1, 1);
    const double s = 2 / std::fma(x, x, std::fma(y, y, std::fma(z, z, w * w)));  // of a quaternion of any length
    const auto off = [s](double a, double b, double c, double d) { return std::fma(s * a, b, s * c * d); };
    const auto on = [s](double a, double b) { return std::fma(-s * a, a, std::fma(-s * b, b, 1)); };
    Eigen::Isometry3d m = Eigen::Isometry3d::Identity();
    m.linear() << on(y, z), off(x, y, -z, w), off(x, z, y, w), off(x, y, z, w), on(x, z), off(y, z, -x, w),
        off(x, z, -y, w), off(y, z, x, w), on(x, y);
    m.translation() << uniform(-half, half), uniform(-half, half), uniform(-half, half);
    return m;
  }
  std::vector<vec3> points(std::size_t n, double half, vec3 center = {0, 0, 0}) {
    std::vector<vec3> all(n);
    for (vec3& p : all) p = point(half, center);
    return all;
  }
  inner_sphere sphere(double half, double smallest, double largest) {
    return {point(half), real(smallest * std::pow(largest / smallest, uniform(0, 1)))};
  }
  triangle face(double half, double size, vec3 center = {0, 0, 0}) {
    const vec3 a = point(half, center), b = a + point(size), c = a + point(size);
    return triangle::from(a, b, c);
  }

 private:
  std::mt19937 engine_;
};

inline std::vector<inner_sphere> random_spheres(dice& d, std::size_t n, double half = 1, double largest = 0.1) {
  std::vector<inner_sphere> all;
  while (all.size() < n) all.push_back(d.sphere(half, largest / 30, largest));
  return all;
}
inline std::vector<triangle> random_triangles(dice& d, std::size_t n, double half = 1, double size = 0.1) {
  std::vector<triangle> all;
  while (all.size() < n) all.push_back(d.face(half, size));
  return all;
}
template <class P>
std::vector<P> random_primitives(dice& d, std::size_t n, double half = 1, double size = 0.1) {
  if constexpr (std::is_same_v<P, inner_sphere>)
    return random_spheres(d, n, half, size);
  else
    return random_triangles(d, n, half, size);
}

}  // namespace testing
