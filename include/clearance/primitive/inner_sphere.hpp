// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A sphere inside a solid: many of them together stand for the solid.

#include <clearance/concepts/capsule.hpp>

#include <array>

namespace clearance {

/// A ball packed inside a solid (Weller & Zachmann 2009). Metres; the distance is negative inside.
struct inner_sphere {
  vec3 center;
  real radius;

  CLEARANCE_HD real distance(vec3 q) const { return length(q - center) - radius; }
  /// `distance` but for its root: see rootless_primitive.
  struct rootless {
    real squared, radius;
    CLEARANCE_HD real distance(real root) const { return root - radius; }
  };
  CLEARANCE_HD rootless before_root(vec3 q) const {
    const vec3 way = q - center;
    return {dot(way, way), radius};
  }
  /// See swept_primitive.
  CLEARANCE_HD real least_along(vec3 from, vec3 along) const { return clearance::least_along(center, from, along); }
  CLEARANCE_HD vec3 nearest(vec3 q) const {
    const vec3 n = normal(q);
    return fma(radius, n == vec3{0, 0, 0} ? vec3{1, 0, 0} : n,
               center);  // at the centre the whole surface is equally near
  }
  CLEARANCE_HD vec3 normal(vec3 q) const {
    const vec3 d = q - center;
    const real l = length(d);
    return l > 0 ? scaled(divide(1, l), d) : vec3{0, 0, 0};
  }
  CLEARANCE_HD primitive_tangent tangent_at(vec3 q) const {
    const unit_way way(q - center);
    const real off = slack * (way.length + absolute(radius)), d = way.length - radius;
    return {{d - off, way.direction}, d + off, way.length};
  }
  CLEARANCE_HD core_place core_at(vec3) const { return {center, radius}; }
  std::array<ball, 1> balls() const { return {{{center, radius}}}; }
};

static_assert(swept_primitive<inner_sphere>);

}  // namespace clearance
