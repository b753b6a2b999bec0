// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The questions that take balls around points, and a long wall of them, whose largest balls lie far from the robot.

#include "support/chunked.hpp"
#include "support/same_answer.hpp"

#include <clearance/deadline.hpp>
#include <clearance/questions/certain_distance.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/zones.hpp>

namespace testing {

/// A radius that depends on the number of the point, in memory or not.
struct by_number {
  CLEARANCE_HD real operator()(std::size_t i, vec3) const { return real(i % 7) * 0.01f; }
};

/// Calls `f(name, question, poses)` for each of them, about a robot of two parts.
template <class F>
void for_each_question_of_balls(const std::vector<Eigen::Isometry3d>& poses, const F& f) {
  const std::vector<double> radii{0.02, 0.01};
  f("min_distance", clearance::min_distance{}, poses);
  f("min_distance_per_part", clearance::min_distance_per_part{}, poses);
  f("certain_distance", clearance::certain_distance{{{0.01, 0.02}, {0, 0.01}}}, poses);
  f("in_collision", clearance::in_collision{{0.05}, radii}, poses);
  f("in_collision, deep", clearance::in_collision{{-0.2}, radii}, poses);
  f("within", clearance::within{{0.3}}, poses);
  f("nearest_k", clearance::nearest_k{.k = 9}, poses);
  f("distances_per_part", clearance::distances_per_part{.d_max = 0.5}, poses);
  f("zones", clearance::zones{.thresholds = {0.1, 0.4}, .radii = radii}, poses);
  std::vector<Eigen::Isometry3d> many = poses;
  for (const auto& pose : poses) many.push_back(shifted(0.3, -0.1, 0) * pose);
  f("min_distances", clearance::min_distances{infinity, radii}, many);
  f("min_distances_per_part", clearance::min_distances_per_part{0.8, radii}, many);
  f("in_collisions", clearance::in_collisions{{0.1}, radii}, many);
}

/// Points of a wall with radii: a few are as long as the wall, so that a point that is far away may be the nearest.
struct wall_of_balls {
  std::vector<vec3> points;
  std::vector<real> radii;

  explicit wall_of_balls(std::size_t n, real bad = 0) : points(wall(n)) {
    dice d(21);
    for (std::size_t i = 0; i < n; ++i) radii.push_back(d.below(3) == 0 ? 0 : d.number(0, 0.3));
    for (std::size_t i = n / 9; i < n; i += n / 5 + 1)
      radii[i] = real(clearance::length(points[i])) * d.number(0.4, 1.1);
    for (std::size_t i = 5; i < n && bad != 0; i += 4000) radii[i] = bad;
  }
  auto on(const vec3* at, const real* its) const {
    return clearance::uncertain(clearance::point_span(at, points.size()), clearance::point_radii(its, points.size()),
                                {0.002, 0.001, 0.5, 0.02});
  }
  auto source() const { return on(points.data(), radii.data()); }
};

}  // namespace testing
