// SPDX-License-Identifier: BSD-3-Clause
// expected-error: balls are inner spheres
#include <clearance/as_balls.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/triangle.hpp>
#include <clearance/volume/aabb.hpp>

std::size_t clouds(const std::vector<std::vector<clearance::triangle>>& links,
                   const std::vector<Eigen::Isometry3d>& poses) {
  const auto other = clearance::make_model<clearance::aabb>(links);
  const auto balls = as_balls(other, poses);
  return sizeof balls;
}
