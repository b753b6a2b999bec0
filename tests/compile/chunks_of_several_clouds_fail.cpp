// SPDX-License-Identifier: BSD-3-Clause
// expected-error: what is read in chunks is one cloud, chunked(source): ask about others by themselves, and merge
// and no other error
#include <clearance/chunked_query.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

void ask(const std::vector<std::vector<clearance::inner_sphere>>& links,
         const std::vector<clearance::placed<clearance::point_span>>& clouds) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  const std::vector poses(robot.size(), Eigen::Isometry3d::Identity());
  clearance::chunked_query prepared(clearance::host{}, robot, clearance::min_distance{});
  prepared(poses, clouds);
}
