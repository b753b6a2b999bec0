// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Leaf formulas, rigid transform and deprojection again, in long double and by other ways than the library's, so that
// brute force and query cannot share an error. It includes nothing of the library.

#include <algorithm>
#include <cmath>

namespace oracle {

using wide = long double;

struct vec {
  wide x, y, z;

  friend vec operator+(vec a, vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend vec operator-(vec a, vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend vec operator*(wide s, vec a) { return {s * a.x, s * a.y, s * a.z}; }
};

/// Widens anything with x, y and z.
template <class T>
vec wider(const T& p) {
  return {wide(p.x), wide(p.y), wide(p.z)};
}

inline wide dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline wide length(vec a) { return std::sqrt(dot(a, a)); }
inline wide between(vec a, vec b) { return length(a - b); }

/// Signed: negative inside.
inline wide to_sphere(vec q, vec center, wide radius) { return between(q, center) - radius; }

inline wide to_segment(vec q, vec a, vec b) {
  const vec edge = b - a;
  const wide squared = dot(edge, edge);
  const wide t = squared > 0 ? std::clamp(dot(q - a, edge) / squared, wide(0), wide(1)) : wide(0);
  return between(q, a + t * edge);
}

/// The least distance to segments parallel to bc that make up the triangle. It is a convex function of their height, so
/// a golden section finds its minimum. Without a normal, plane or region, no triangle is special.
inline wide to_triangle(vec q, vec a, vec b, vec c) {
  const auto at = [&](wide t) { return to_segment(q, a + t * (b - a), a + t * (c - a)); };
  constexpr wide golden = 0.618033988749894848204586834365638118L;
  wide low = 0, high = 1, left = 1 - golden, right = golden, at_left = at(left), at_right = at(right);
  for (int k = 0; k < 92; ++k) {
    if (at_left <= at_right) {
      high = right, right = left, at_right = at_left;
      left = high - golden * (high - low), at_left = at(left);
    } else {
      low = left, left = right, at_left = at_right;
      right = low + golden * (high - low), at_right = at(right);
    }
  }
  return std::min({at_left, at_right, at(low), at(high), at(0), at(1)});
}

/// Row-major world-from-something; any matrix with (row, column).
template <class Pose>
vec moved(const Pose& m, vec p) {
  const auto row = [&](int k) {
    return wide(m(k, 0)) * p.x + wide(m(k, 1)) * p.y + wide(m(k, 2)) * p.z + wide(m(k, 3));
  };
  return {row(0), row(1), row(2)};
}

/// The inverse of a rigid `moved`.
template <class Pose>
vec moved_back(const Pose& m, vec p) {
  const vec d{p.x - wide(m(0, 3)), p.y - wide(m(1, 3)), p.z - wide(m(2, 3))};
  const auto column = [&](int k) { return wide(m(0, k)) * d.x + wide(m(1, k)) * d.y + wide(m(2, k)) * d.z; };
  return {column(0), column(1), column(2)};
}

/// Pinhole: pixel centres at integers, z forward.
inline vec deprojected(wide u, wide v, wide z, wide fx, wide fy, wide cx, wide cy) {
  return {(u - cx) / fx * z, (v - cy) / fy * z, z};
}

}  // namespace oracle
