// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points that lie together, or almost, for walks by tangents.

#include "support/random.hpp"

namespace testing {

/// Neighbours of all sizes and shapes, among them repeated, far and missing points.
inline std::vector<vec3> patches(dice& d, double extent) {
  std::vector<vec3> points;
  for (int patch = 0; patch < 60; ++patch) {
    const vec3 corner = d.point(extent * (patch % 5 == 0 ? 20 : 1), {0, 0, 0});
    const real step = real(extent * std::pow(10, d.number(-6, -1)));
    const vec3 along = d.point(1, {0, 0, 0}), across = d.point(1, {0, 0, 0});
    const int columns = 1 + int(d.below(64));
    for (int i = 0; i < 96; ++i) {
      vec3 p =
          clearance::fma(step * real(i % columns), along, clearance::fma(step * real(i / columns), across, corner));
      if (patch % 4 == 1 && i % 7 == 0) p = p + d.point(extent, {0, 0, 0});  // strangers
      if (patch % 3 == 1 && i % 11 == 0) p.x = clearance::not_a_number;
      if (patch % 7 == 2) p = corner;
      points.push_back(p);
    }
  }
  return points;
}

}  // namespace testing
