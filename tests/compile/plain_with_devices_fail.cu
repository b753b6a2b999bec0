// SPDX-License-Identifier: BSD-3-Clause
// expected-error: plain takes one backend, host{} or device{}
#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/traversal/stack.hpp>
#include <clearance/volume/sphere.hpp>

void far(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points) {
  const clearance::devices both{0, 1};
  const auto robot = clearance::make_model<clearance::sphere>(links).on(both);
  clearance::ask(clearance::plain{both, clearance::stack{}}, robot, std::vector{Eigen::Isometry3d::Identity()}, points,
                 clearance::min_distance{});
}
