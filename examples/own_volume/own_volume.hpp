// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A bounding volume of one's own. Nothing of it is in the library, and the library needs no change for it.

#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>

#include <cstdio>

// [volume]
/// A 14-DOP: slabs along the three axes and the four diagonals of a cube, measured from a centre.
struct dop14 {
  clearance::vec3 center;
  clearance::real lower[7], upper[7], size;

  /// On the host, in double, and rounded outward: the centre is a float, so what is measured from it is exact to 1e-16.
  static dop14 fit(std::span<const clearance::ball> balls) {
    const clearance::aabb box = clearance::aabb::fit(balls);  // any point would do as centre
    dop14 v;
    v.center = clearance::scaled(0.5f, box.lower + box.upper);
    v.size = 0;
    for (int k = 0; k < 7; ++k) {
      const clearance::vec3 n = direction(k);
      double lo = clearance::infinity, hi = -clearance::infinity;
      for (const auto& [c, r] : balls) {
        const double t = double(n.x) * (double(c.x) - v.center.x) + double(n.y) * (double(c.y) - v.center.y) +
                         double(n.z) * (double(c.z) - v.center.z);
        lo = std::min(lo, t - r), hi = std::max(hi, t + r);
      }
      v.lower[k] = clearance::rounded_down(lo);
      v.upper[k] = clearance::rounded_up(hi);
      v.size = std::max({v.size, -v.lower[k], v.upper[k]});
    }
    return v;
  }

  /// No point of the enclosed can be nearer than the farthest slab: positive outside, negative inside.
  CLEARANCE_HD clearance::real lower_bound(clearance::vec3 q) const {
    const clearance::vec3 d = q - center;
    clearance::real farthest = -clearance::infinity;
    for (int k = 0; k < 7; ++k) {
      const clearance::real t = clearance::dot(direction(k), d);
      farthest = clearance::max(farthest, clearance::max(lower[k] - t, t - upper[k]));
    }
    return clearance::lowered(farthest, size);  // more than all rounding on the way here
  }

 private:
  CLEARANCE_HD static constexpr clearance::vec3 direction(int k) {
    constexpr clearance::real d = 0.57735027f;  // 1 / sqrt(3)
    if (k < 3) return {k == 0 ? 1.0f : 0.0f, k == 1 ? 1.0f : 0.0f, k == 2 ? 1.0f : 0.0f};
    return {d, k & 1 ? d : -d, k < 5 ? d : -d};
  }
};

static_assert(clearance::explain_bounding_volume<dop14>());
// [volume]

template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<clearance::inner_sphere> diagonal;
  for (int k = 0; k < 200; ++k) diagonal.push_back({{0.01f * k, 0.01f * k, -0.01f * k}, 0.02f});
  std::vector<clearance::vec3> cloud;
  for (int k = 0; k < 5000; ++k) cloud.push_back({2 - 0.0004f * k, 0.0003f * k, 0.3f - 0.0002f * k});
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();

  // [use]
  const auto part = clearance::make_part(clearance::build<dop14>(diagonal)).on(on);
  const auto mine = clearance::ask(on, part, pose, cloud, clearance::min_distance{});
  // [use]

  // Whatever the volume, the answer has the same bits.
  const auto boxes = clearance::make_part(clearance::build<clearance::aabb>(diagonal)).on(on);
  const auto theirs = clearance::ask(on, boxes, pose, cloud, clearance::min_distance{});
  std::printf("%.6f m to point %u with my volume, %.6f m to point %u with a box\n", mine.distance, mine.point,
              theirs.distance, theirs.point);
  return mine.distance == theirs.distance && mine.point == theirs.point && mine.primitive == theirs.primitive ? 0 : 1;
}
