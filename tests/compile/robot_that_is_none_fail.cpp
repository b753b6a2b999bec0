// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a robot is: a model (make_model), its view, or one part. The arguments are: backend, robot, poses
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

using bodies = std::vector<std::vector<clearance::inner_sphere>>;
using cloud = std::vector<clearance::vec3>;

void far(const bodies& links, const cloud& points) {
  clearance::ask(clearance::host{}, links, std::vector{Eigen::Isometry3d::Identity()}, points,
                 clearance::min_distance{});
}
