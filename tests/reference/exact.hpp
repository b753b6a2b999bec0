// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Distances by definition, in a wide type. Other ways than the library's; it includes nothing of the library.

#include <algorithm>
#include <cmath>
#include <limits>

namespace reference {

template <class T>
struct vec {
  T x, y, z;

  friend vec operator+(vec a, vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend vec operator-(vec a, vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend vec operator*(T s, vec a) { return {s * a.x, s * a.y, s * a.z}; }
};

template <class T, class V>
vec<T> wider(const V& p) {
  return {T(p.x), T(p.y), T(p.z)};
}
template <class T>
T dot(vec<T> a, vec<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
vec<T> cross(vec<T> a, vec<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T length(vec<T> a) {
  return std::sqrt(dot(a, a));
}

/// The place of a segment that is nearest to the origin.
template <class T>
vec<T> nearest_of_segment(vec<T> a, vec<T> b) {
  const vec<T> edge = b - a;
  const T square = dot(edge, edge), along = -dot(a, edge);
  if (!(square > 0) || along <= 0) return a;
  return along >= square ? b : a + (along / square) * edge;
}

/// The place of a triangle that is nearest to the origin: the foot on its plane, if three sides have it on their inner
/// side, else the nearest place of three sides.
template <class T>
vec<T> nearest_of_triangle(vec<T> a, vec<T> b, vec<T> c) {
  vec<T> best = nearest_of_segment(a, b);
  for (const vec<T> other : {nearest_of_segment(b, c), nearest_of_segment(c, a)})
    if (dot(other, other) < dot(best, best)) best = other;
  const vec<T> normal = cross(b - a, c - a);
  const T square = dot(normal, normal);
  if (!(square > 0)) return best;
  const vec<T> foot = (dot(a, normal) / square) * normal;
  const auto inner = [&](vec<T> p, vec<T> q) { return dot(cross(q - p, foot - p), normal) >= 0; };
  return inner(a, b) && inner(b, c) && inner(c, a) && dot(foot, foot) < dot(best, best) ? foot : best;
}
template <class T>
T to_triangle(vec<T> q, vec<T> a, vec<T> b, vec<T> c) {
  return length(nearest_of_triangle(a - q, b - q, c - q));
}

/// Between two segments: at an end of either, or where both interiors are nearest.
template <class T>
T between_segments(vec<T> a, vec<T> b, vec<T> c, vec<T> d) {
  T least = std::min({length(nearest_of_segment(a - c, b - c)), length(nearest_of_segment(a - d, b - d)),
                      length(nearest_of_segment(c - a, d - a)), length(nearest_of_segment(c - b, d - b))});
  const vec<T> u = b - a, v = d - c, w = a - c;
  const T uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), uw = dot(u, w), vw = dot(v, w), area = uu * vv - uv * uv;
  if (!(area > 0)) return least;
  const T s = (uv * vw - vv * uw) / area, t = (uu * vw - uv * uw) / area;
  if (s > 0 && s < 1 && t > 0 && t < 1) least = std::min(least, length(w + s * u - t * v));
  return least;
}

/// From a segment to a triangle: 0 where it passes through, else at one of its ends or at a side.
template <class T>
T segment_to_triangle(vec<T> p, vec<T> q, vec<T> a, vec<T> b, vec<T> c) {
  const vec<T> normal = cross(b - a, c - a);
  const T from = dot(p - a, normal), to = dot(q - a, normal);
  if ((from <= 0) != (to <= 0)) {
    const vec<T> at = p + (from / (from - to)) * (q - p);
    const auto inner = [&](vec<T> e, vec<T> f) { return dot(cross(f - e, at - e), normal) >= 0; };
    if (inner(a, b) && inner(b, c) && inner(c, a)) return 0;
  }
  return std::min({to_triangle(p, a, b, c), to_triangle(q, a, b, c), between_segments(p, q, a, b),
                   between_segments(p, q, b, c), between_segments(p, q, c, a)});
}

}  // namespace reference
