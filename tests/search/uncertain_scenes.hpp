// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Scenes whose points and parts have radii, and what a plain loop over all pairs says about them.

#include "support/brute_pairs.hpp"
#include "support/product.hpp"
#include "support/same_result.hpp"

#include <clearance/questions/certain_distance.hpp>

namespace testing {

using clearance::certain_distance, clearance::certain_distance_result, clearance::cloud_uncertainty;

inline bool same_pair(const clearance::certain_pair& a, const clearance::certain_pair& b) {
  return same_witness(a, b) && same_bits(a.lower, b.lower) && same_bytes(a.shares, b.shares);
}
inline bool same_certain(const certain_distance_result& a, const certain_distance_result& b) {
  return a.state == b.state && a.anywhere == b.anywhere && same_bits(a.lower, b.lower) && same_bits(a.upper, b.upper) &&
         same_result(a.nominal, b.nominal) && same_pair(a.certain, b.certain) &&
         std::equal(a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end(), same_pair);
}

/// A scene's points with a radius each, some of them 0, and its parts with radii.
template <class P>
struct uncertain_scene {
  scene<P> s;
  std::vector<real> radii;
  std::vector<clearance::part_radius> parts;
  cloud_uncertainty all;

  uncertain_scene(const scene<P>& of, unsigned seed, double scale) : s(of) {
    dice d(seed);
    for (std::size_t i = 0; i < s.points.size(); ++i)
      radii.push_back(d.below(4) == 0 ? 0 : d.number(0, scale * s.size));
    for (std::size_t k = 0; k < s.parts.size(); ++k) {
      const double joints = d.uniform(0, 0.3 * scale * s.size), delay = d.uniform(0, 0.3 * scale * s.size);
      parts.push_back({joints, delay});
    }
    all = {0.01 * scale * s.size, 1e-3 * scale, 0.1 * scale * s.size, 0.2};
  }

  auto source(const real* at, const clearance::vec3* points) const {
    return clearance::uncertain(clearance::point_span(points, s.points.size()),
                                clearance::point_radii(at, radii.size()), all);
  }
  auto source() const { return source(radii.data(), s.points.data()); }
};

}  // namespace testing
