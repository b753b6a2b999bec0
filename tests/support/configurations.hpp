// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Many configurations of a scene's robot; their least distances must be those of one at a time.

#include "support/product.hpp"
#include "support/same_result.hpp"

#include <clearance/questions/min_distances.hpp>

namespace testing {

using configurations = std::vector<Eigen::Isometry3d>;

/// The scene's own poses, exact shifts of them (so that ties stay ties), and turns of all parts together or of each by
/// itself; some are far away.
template <class P>
configurations configurations_of(const scene<P>& s, dice& d, std::size_t count = 9) {
  configurations all;
  for (std::size_t c = 0; c < count; ++c) {
    const double along = c < 3 ? 0.25 * double(c) : 50;
    const Eigen::Isometry3d together = c < 3 || c == 8 ? shifted(along * s.size, 0, 0) : d.pose(0.5 * s.size);
    for (const auto& pose : s.poses)
      all.push_back(c < 3 || c == 8 ? together * pose : pose * together * d.pose(0.1 * s.size));
  }
  return all;
}

/// `one(poses)` is min_distance for one configuration.
template <class One>
void require_same(const clearance::min_distances_result& found, const configurations& poses, std::size_t parts,
                  real d_max, One one, verdict& v, const std::string& what, double spread = 0) {
  v.require(found.of.size() * parts == poses.size(), what, ": another number of results");
  for (std::size_t c = 0; c < found.of.size() && (c + 1) * parts <= poses.size(); ++c) {
    const clearance::min_distance_result expected = one(std::span(poses).subspan(c * parts, parts)), &r = found.of[c];
    if (expected.part == clearance::none || expected.distance <= d_max) {
      v.require(same_result(r, expected), what, ", configuration", c, ": ", r.distance, " at", r.point, ",", r.part,
                " instead of", expected.distance, " at", expected.point, ",", expected.part, "; bracket", r.lower,
                r.upper, expected.lower, expected.upper);
      continue;
    }
    v.require(r.distance == clearance::infinity && r.upper == clearance::infinity && r.cloud == clearance::none &&
                  r.point == clearance::none && r.part == clearance::none && r.primitive == clearance::none,
              what, ", configuration", c, ": beyond d_max there is", r.distance);
    v.require(r.lower >= 0 && r.lower <= std::max(d_max, real(0)) && r.lower <= expected.lower, what, ", configuration",
              c, ": lower is", r.lower);
    // The width of the bracket hardly depends on the distance. Beyond d_max the greatest tolerance is taken.
    v.require(r.lower >= expected.lower - (expected.distance - d_max) * 1.001f - 1e-6f * expected.distance - spread,
              what, ", configuration", c, ": lower is", r.lower, ", too little");
    v.require(r.state == (r.lower > 0 ? clearance::state::free : clearance::state::possible), what, ", configuration",
              c, ": another state");
    v.require(r.seen == expected.seen && r.valid == expected.valid &&
                  std::equal(r.dropped, r.dropped + clearance::drop_reasons, expected.dropped),
              what, ", configuration", c, ": other counts");
  }
}

}  // namespace testing
