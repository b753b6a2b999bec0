// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a robot is asked about itself if its parts are inner spheres
#include <clearance/make_model.hpp>
#include <clearance/primitive/triangle.hpp>
#include <clearance/self_distance.hpp>
#include <clearance/volume/aabb.hpp>

clearance::state itself(const std::vector<std::vector<clearance::triangle>>& links,
                        const std::vector<Eigen::Isometry3d>& poses) {
  const auto robot = clearance::make_model<clearance::aabb>(links);
  return self_distance(clearance::host{}, robot, poses, clearance::part_pairs(links.size())).state;
}
