// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Triangles over a closed polygon in space: over faces of files, and over the holes of a mesh.

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace clearance {

using polygon_triangles = std::vector<std::array<std::uint32_t, 3>>;

/// Square metres, of all triangles together.
inline double area_of(std::span<const Eigen::Vector3d> vertices, const polygon_triangles& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles)
    sum += (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]).norm() / 2;
  return sum;
}

/// Half the sum of the corners' cross products: normal to the polygon's mean plane. No surface over the polygon has an
/// area below its length.
inline Eigen::Vector3d vector_area(std::span<const Eigen::Vector3d> vertices, std::span<const std::uint32_t> polygon) {
  const Eigen::Vector3d& origin = vertices[polygon[0]];  // a polygon far from zero keeps its digits
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    sum += (vertices[polygon[i]] - origin).cross(vertices[polygon[i + 1]] - origin) / 2;
  return sum;
}

namespace detail {

/// Cuts ears off a polygon, seen along its vector area. Corners may repeat, as those of a bridge from a polygon to a
/// hole in it do. What has no ear, because it crosses itself as it is seen so, is left.
class ear_cutter {
 public:
  ear_cutter(std::span<const Eigen::Vector3d> vertices, std::span<const std::uint32_t> polygon,
             const Eigen::Vector3d& normal)
      : polygon_(polygon), before_(polygon.size()), after_(polygon.size()) {
    const Eigen::Vector3d x = normal.normalized().unitOrthogonal(), y = normal.normalized().cross(x);
    const auto n = std::uint32_t(polygon.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      const Eigen::Vector3d p = vertices[polygon[i]] - vertices[polygon[0]];
      flat_.emplace_back(p.dot(x), p.dot(y));
      before_[i] = (i + n - 1) % n;
      after_[i] = (i + 1) % n;
    }
    for (std::uint32_t i = 0; i < n; ++i)
      if (!convex(i)) bays_.push_back(i);
  }

  /// Corners that no ear was cut from, as positions in the polygon. Every look at a corner takes one of `patience`;
  /// without any left, it stops.
  std::vector<std::uint32_t> cut(polygon_triangles& triangles, std::size_t& patience) {
    std::size_t left = polygon_.size(), failures = 0;
    std::uint32_t at = 1;  // so that the first cut of a quad is from its first corner to its third
    while (left > 3 && failures < left && patience > 0) {
      const std::uint32_t a = before_[at], c = after_[at];
      if (is_ear(at, patience)) {
        triangles.push_back({polygon_[a], polygon_[at], polygon_[c]});
        after_[a] = c;
        before_[c] = a;
        std::erase_if(bays_, [&](std::uint32_t i) { return (i == a || i == c) && convex(i); });
        patience -= std::min(patience, bays_.size() / 8);
        --left;
        failures = 0;
        at = after_[c];  // skipping one makes fatter ears than going round in order
      } else {
        at = c;
        ++failures;
      }
    }
    std::vector<std::uint32_t> rest{at};
    for (std::uint32_t i = after_[at]; i != at; i = after_[i]) rest.push_back(i);
    std::rotate(rest.begin(), std::min_element(rest.begin(), rest.end()), rest.end());
    return rest;
  }

 private:
  double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Eigen::Vector2d u = flat_[b] - flat_[a], v = flat_[c] - flat_[a];
    return u.x() * v.y() - u.y() * v.x();
  }
  bool convex(std::uint32_t i) const { return turn(before_[i], i, after_[i]) > 0; }

  /// Only corners of bays can lie in an ear.
  bool is_ear(std::uint32_t b, std::size_t& patience) const {
    patience -= patience > 0;
    if (!convex(b)) return false;
    const std::uint32_t a = before_[b], c = after_[b];
    for (const std::uint32_t p : bays_) {
      if (patience == 0) return false;
      --patience;
      if (p == a || p == c) continue;
      if (flat_[p] == flat_[a] || flat_[p] == flat_[c]) continue;  // a way from there into the ear has a corner in it
      if (flat_[p] == flat_[b]) {
        for (const std::uint32_t q : {before_[p], after_[p]})
          if (turn(a, b, q) > 0 && turn(b, c, q) > 0) return false;  // one from here may leave it by the cut
        continue;
      }
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
  }

  std::span<const std::uint32_t> polygon_;
  std::vector<std::uint32_t> before_, after_;  // of the corners that are left
  std::vector<std::uint32_t> bays_;            // corners that are not convex
  std::vector<Eigen::Vector2d> flat_;
};

/// The triangles of least area, by dynamic programming (G. Klincsek, 1980). Takes the third power of the number of
/// corners, a fiftieth of a second for 256.
inline polygon_triangles least_area(std::span<const Eigen::Vector3d> vertices, std::span<const std::uint32_t> polygon) {
  const std::size_t n = polygon.size();
  std::vector<double> least(n * n, 0);           // of the corners from i to j
  std::vector<std::uint32_t> between(n * n, 0);  // the third corner of the triangle at the side from j to i
  for (std::size_t width = 2; width < n; ++width)
    for (std::size_t i = 0; i + width < n; ++i) {
      const std::size_t j = i + width;
      const Eigen::Vector3d &a = vertices[polygon[i]], side = vertices[polygon[j]] - a;
      double best = std::numeric_limits<double>::infinity();
      between[i * n + j] = std::uint32_t(i + 1);  // if no area is finite
      for (std::size_t k = i + 1; k < j; ++k) {
        const double rest = least[i * n + k] + least[k * n + j];
        if (!(rest < best)) continue;
        const double area = rest + side.cross(vertices[polygon[k]] - a).norm() / 2;
        if (area < best) {
          best = area;
          between[i * n + j] = std::uint32_t(k);
        }
      }
      least[i * n + j] = best;
    }
  polygon_triangles triangles;
  std::vector<std::pair<std::size_t, std::size_t>> sides{{0, n - 1}};
  while (!sides.empty()) {
    const auto [i, j] = sides.back();
    sides.pop_back();
    if (j < i + 2) continue;
    const std::size_t k = between[i * n + j];
    triangles.push_back({polygon[i], polygon[k], polygon[j]});
    sides.emplace_back(i, k);
    sides.emplace_back(k, j);
  }
  return triangles;
}

/// From how many corners `zipped` starts.
inline std::size_t zip_tries(std::size_t corners) {
  return std::min(corners, std::max<std::size_t>(8, 4'000'000 / corners));
}

/// Goes along both sides of a polygon at once, from the corner where that covers the least area, and takes the shorter
/// way across each time: right for a crack, however long and bent.
inline polygon_triangles zipped(std::span<const Eigen::Vector3d> vertices, std::span<const std::uint32_t> polygon) {
  const std::size_t n = polygon.size();
  const auto corner = [&](std::size_t i) -> const Eigen::Vector3d& { return vertices[polygon[i % n]]; };
  const auto zip = [&](std::size_t start, auto take) {
    std::size_t left = start + n - 1, right = start + 1;  // their side is open
    take(left, start, right);
    while (left - right > 1) {
      const bool by_left =
          (corner(left - 1) - corner(right)).squaredNorm() < (corner(right + 1) - corner(left)).squaredNorm();
      if (by_left) {
        take(left, right, left - 1);
        --left;
      } else {
        take(left, right, right + 1);
        ++right;
      }
    }
  };
  // The ends of a crack are its sharpest corners.
  std::vector<std::pair<double, std::uint32_t>> ends;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d back = corner(i + n - 1) - corner(i), on = corner(i + 1) - corner(i);
    const double sharp = -back.dot(on) / std::max(back.norm() * on.norm(), 1e-300);
    ends.emplace_back(std::isnan(sharp) ? 0 : sharp, std::uint32_t(i));  // sides beyond 1e154 metres
  }
  const std::size_t tries = zip_tries(n);
  std::partial_sort(ends.begin(), ends.begin() + std::ptrdiff_t(tries), ends.end());
  double least = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
  for (std::size_t k = 0; k < tries; ++k) {
    double area = 0;
    zip(ends[k].second, [&](std::size_t a, std::size_t b, std::size_t c) {
      area += (corner(b) - corner(a)).cross(corner(c) - corner(a)).norm() / 2;
    });
    if (area < least) {
      least = area;
      best = ends[k].second;
    }
  }
  polygon_triangles triangles;
  zip(best, [&](std::size_t a, std::size_t b, std::size_t c) {
    triangles.push_back({polygon[a % n], polygon[b % n], polygon[c % n]});
  });
  return triangles;
}

}  // namespace detail

/// How much larger than its vector area a surface may be that is still called flat: a cap, and a face, of which most
/// programs cut off ears even if it is bent.
inline constexpr double nearly_flat = 1.01, bent_face = 1.5;

/// Triangles over a closed polygon: after inner sides cancel, their sides are the polygon's, in its direction. Ears are
/// cut off as long as they cover what the polygon does; else (it is bent, crosses itself, or is a crack) the least area
/// is looked for. `bent`: how much larger than the vector area a surface of ears may be. `patience`: how many corners
/// may still be looked at; without any left the result may be rough.
inline polygon_triangles span_polygon(std::span<const Eigen::Vector3d> vertices, std::span<const std::uint32_t> polygon,
                                      std::size_t& patience, double bent = nearly_flat) {
  if (polygon.size() == 3) return {{polygon[0], polygon[1], polygon[2]}};
  polygon_triangles best;
  double area = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d normal = vector_area(vertices, polygon);
  const double flat = normal.norm();
  if (flat > 0 && std::isfinite(flat)) {
    const std::vector<std::uint32_t> left = detail::ear_cutter(vertices, polygon, normal).cut(best, patience);
    for (std::size_t i = 1; i + 1 < left.size(); ++i)
      best.push_back({polygon[left[0]], polygon[left[i]], polygon[left[i + 1]]});
    area = area_of(vertices, best);
    if (area <= bent * flat) return best;
  }
  constexpr std::size_t few = 256;
  const std::size_t n = polygon.size(), all = n * n * n / 6, looks = n <= few ? all : n * detail::zip_tries(n);
  if (looks > patience) {
    patience = 0;
    if (!best.empty()) return best;
  } else {
    patience -= looks;
  }
  polygon_triangles other = n <= few ? detail::least_area(vertices, polygon) : detail::zipped(vertices, polygon);
  return best.empty() || area_of(vertices, other) * nearly_flat < area ? other : best;  // what is as good stays
}

}  // namespace clearance
