// SPDX-License-Identifier: BSD-3-Clause
// expected-error: several devices take a robot that is on each of them: model.on(devices)
#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

clearance::real far(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  return clearance::ask(clearance::devices{0, 1}, robot, std::vector{Eigen::Isometry3d::Identity()}, points,
                        clearance::min_distance{})
      .distance;
}
