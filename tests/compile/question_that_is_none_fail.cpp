// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a question needs: a type result. The arguments are: backend, robot (or part), poses, clouds, question
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

using bodies = std::vector<std::vector<clearance::inner_sphere>>;
using cloud = std::vector<clearance::vec3>;

void far(const bodies& links, const cloud& points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  clearance::ask(clearance::host{}, robot, std::vector{Eigen::Isometry3d::Identity()}, points, 0.05);
}
