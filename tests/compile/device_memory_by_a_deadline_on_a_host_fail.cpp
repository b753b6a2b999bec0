// SPDX-License-Identifier: BSD-3-Clause
// expected-error: these points are in a device's memory, which a host cannot read: ask a device{} about them, or copy them
#include <clearance/deadline.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

clearance::real far(const std::vector<std::vector<clearance::inner_sphere>>& links,
                    const clearance::in_device_memory<clearance::point_span>& points) {
  return clearance::ask_by(clearance::host{}, clearance::make_model<clearance::sphere>(links),
                           std::vector{Eigen::Isometry3d::Identity()}, points, std::chrono::seconds(1),
                           clearance::min_distance{})
      .result.distance;
}
