// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a question about many configurations is enqueued without poses, on a device{}: place(poses), then enqueue(clouds)
// and no other error
#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/volume/sphere.hpp>

void enqueue(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points,
             clearance::min_distance_result* to) {
  const clearance::device on{};
  const auto robot = clearance::make_model<clearance::sphere>(links).on(on);
  const std::vector poses(links.size(), Eigen::Isometry3d::Identity());
  clearance::query(on, robot, clearance::min_distances{}).enqueue(poses, points, to);
}
