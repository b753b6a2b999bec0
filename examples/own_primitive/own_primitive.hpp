// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A primitive of one's own: capsules in oriented boxes. The box knows nothing of capsules; it sees two balls.

#include <clearance/bvh/build.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/obb.hpp>

#include <array>
#include <cstdio>

// [primitive]
/// All points within `radius` of the segment from a to b. Metres; the distance is negative inside.
struct capsule {
  clearance::vec3 a, b;
  clearance::real radius;

  CLEARANCE_HD clearance::real distance(clearance::vec3 q) const { return clearance::length(q - on_axis(q)) - radius; }
  CLEARANCE_HD clearance::vec3 normal(clearance::vec3 q) const {
    const clearance::vec3 d = q - on_axis(q);
    const clearance::real l = clearance::length(d);
    return l > 0 ? clearance::scaled(clearance::divide(1, l), d) : clearance::vec3{0, 0, 0};
  }
  CLEARANCE_HD clearance::vec3 nearest(clearance::vec3 q) const {
    return clearance::fma(radius, normal(q), on_axis(q));
  }
  /// Their convex hull is the capsule.
  std::array<clearance::ball, 2> balls() const { return {{{a, radius}, {b, radius}}}; }

 private:
  // fma and divide, not * + /: then no compiler can round differently, and CPU and GPU agree to the bit.
  CLEARANCE_HD clearance::vec3 on_axis(clearance::vec3 q) const {
    const clearance::vec3 edge = b - a;
    const clearance::real squared = clearance::dot(edge, edge);
    if (!(squared > 0)) return a;
    return clearance::fma(clearance::clamp01(clearance::divide(clearance::dot(q - a, edge), squared)), edge, a);
  }
};

static_assert(clearance::explain_primitive<capsule>());
// [primitive]

template <clearance::backend Backend>
int example(const Backend& on) {
  const std::vector<capsule> arm = {{{0, 0, 0}, {0, 0, 0.4f}, 0.06f}, {{0, 0, 0.4f}, {0.3f, 0, 0.6f}, 0.05f}};
  const std::vector<clearance::vec3> cloud = {{0.5f, 0.5f, 0.5f}, {0.16f, 0, 0.2f}, {0, 0, -0.3f}};
  const auto part = clearance::make_part(clearance::build<clearance::obb>(arm)).on(on);
  const auto r = clearance::ask(on, part, Eigen::Isometry3d::Identity(), cloud, clearance::min_distance{});
  std::printf("%.6f m from capsule %u to point %u\n", r.distance, r.primitive, r.point);
  return std::abs(r.distance - 0.1f) < 1e-6f && r.primitive == 0 && r.point == 1 && r.normal.x == 1 ? 0 : 1;
}
