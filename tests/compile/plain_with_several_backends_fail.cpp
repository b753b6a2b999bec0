// SPDX-License-Identifier: BSD-3-Clause
// expected-error: plain takes one backend, host{} or device{}
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/traversal/stack.hpp>
#include <clearance/volume/sphere.hpp>

// As devices{0, 1} on a machine without CUDA.
struct cards : clearance::host {
  using several = void;
};

void far(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  clearance::ask(clearance::plain{cards{}, clearance::stack{}}, robot, std::vector{Eigen::Isometry3d::Identity()},
                 points, clearance::zones{{0.1}});
}
