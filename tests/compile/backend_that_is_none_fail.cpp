// SPDX-License-Identifier: BSD-3-Clause
// expected-error: the first argument is a backend: host{}, device{}, devices{...}, or plain{backend, traversal}
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

using bodies = std::vector<std::vector<clearance::inner_sphere>>;
using cloud = std::vector<clearance::vec3>;

void far(const bodies& links, const cloud& points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  clearance::ask(robot, robot, std::vector{Eigen::Isometry3d::Identity()}, points, clearance::min_distance{});
}
