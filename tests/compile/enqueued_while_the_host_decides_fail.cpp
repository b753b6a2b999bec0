// SPDX-License-Identifier: BSD-3-Clause
// expected-error: this question cannot be enqueued, because the host decides while it is answered: ask it, or prepare a query and call that
// and no other error
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/certain_distance.hpp>
#include <clearance/volume/sphere.hpp>

void enqueue(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points,
             clearance::certain_distance_result* to) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  const std::vector poses(robot.size(), Eigen::Isometry3d::Identity());
  clearance::query(clearance::host{}, robot, clearance::certain_distance{}).enqueue(poses, points, to);
}
