// SPDX-License-Identifier: BSD-3-Clause
// expected-error: these points are in a device's memory, which a host cannot read: ask a device{} about them, or copy them
#include <clearance/chunked_query.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

clearance::real far(const std::vector<std::vector<clearance::inner_sphere>>& links,
                    const clearance::in_device_memory<clearance::point_span>& points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  clearance::chunked_query ask(clearance::host{}, robot, clearance::min_distance{});
  clearance::chunked cloud(points);
  return ask(std::vector{Eigen::Isometry3d::Identity()}, cloud).distance;
}
