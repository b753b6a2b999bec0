// SPDX-License-Identifier: BSD-3-Clause
// expected-error: poses are Eigen::Isometry3d, world-from-part, one per part: a vector, an array or a span of them
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

using bodies = std::vector<std::vector<clearance::inner_sphere>>;
using cloud = std::vector<clearance::vec3>;

clearance::real far(const bodies& links, const cloud& points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  const std::vector<Eigen::Matrix4d> poses{Eigen::Matrix4d::Identity()};
  return clearance::ask(clearance::host{}, robot, poses, points, clearance::min_distance{}).distance;
}
