// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/bvh.hpp>

#include <cmath>

namespace clearance {

/// What the bracket needs to know of a part. Metres, in the part's frame.
struct part_facts {
  vec3 center = {0, 0, 0};  ///< A ball around every primitive.
  real radius = infinity;
  real gap = 0;        ///< The solid's largest distance to the primitives, certified; infinite: no certificate.
  real tolerance = 0;  ///< How far the solid may differ from the true surface, either way (tessellation).
};

/// For primitives that know their own inside: nothing else is asked.
struct no_interior {
  static constexpr bool empty = true;

  CLEARANCE_HD bool inside(vec3) const { return false; }
};

/// One rigid body as a kernel sees it: a tree, the test for points inside (or none), and the facts.
template <hierarchy H, class Interior = no_interior>
struct part_view {
  using hierarchy_type = H;
  using interior_type = Interior;

  H tree;
  Interior interior;
  part_facts facts;
};

/// A ball around all of them, in double and rounded up. Not the smallest, but a fair one.
inline ball enclosing_ball(std::span<const ball> balls) {
  double lo[3] = {infinity, infinity, infinity}, hi[3] = {-infinity, -infinity, -infinity};
  for (const ball& b : balls) {
    const double c[3] = {b.center.x, b.center.y, b.center.z};
    for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], c[k] - b.radius), hi[k] = std::max(hi[k], c[k] + b.radius);
  }
  const vec3 center{real((lo[0] + hi[0]) / 2), real((lo[1] + hi[1]) / 2), real((lo[2] + hi[2]) / 2)};
  double radius = 0;
  for (const ball& b : balls) {
    const double d[3] = {double(b.center.x) - center.x, double(b.center.y) - center.y, double(b.center.z) - center.z};
    radius = std::max(radius, std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + b.radius);
  }
  return {center, rounded_up(radius * (1 + 2.0 * slack))};
}

/// Around primitives, in their part's frame.
template <primitive P>
ball enclosing_ball(std::span<const P> primitives) {
  std::vector<ball> balls;
  for (const P& p : primitives)
    for (const ball& b : p.balls()) balls.push_back(b);
  return enclosing_ball(std::span<const ball>(balls));
}

/// Owns what a part_view points to, in the memory of one backend.
template <class Tree, class Interior = no_interior>
struct part {
  Tree tree;
  Interior interior;
  part_facts facts;

  auto view() const {
    if constexpr (requires { interior.view(); })
      return part_view<decltype(tree.view()), decltype(interior.view())>{tree.view(), interior.view(), facts};
    else
      return part_view<decltype(tree.view()), Interior>{tree.view(), interior, facts};
  }

  /// A copy where `other` runs.
  template <backend Other>
  auto on(const Other& other) const {
    if constexpr (requires { interior.on(other); })
      return part<decltype(tree.on(other)), decltype(interior.on(other))>{tree.on(other), interior.on(other), facts};
    else
      return part<decltype(tree.on(other)), Interior>{tree.on(other), interior, facts};
  }
};

/// A part whose primitives are all there is of the solid; or, with a certified `gap`, all but that. Metres.
template <bounding_volume V, primitive P>
part<bvh<V, P>> make_part(bvh<V, P> tree, double gap = 0, double tolerance = 0) {
  const ball around = enclosing_ball(std::span<const P>(tree.primitives));
  return {std::move(tree), {}, {around.center, around.radius, rounded_up(gap), rounded_up(tolerance)}};
}

}  // namespace clearance
