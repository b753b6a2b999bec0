// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a deadline is for a host or a device, not for several
// and no other error
#include <clearance/deadline.hpp>
#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

void ask(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points) {
  const clearance::devices on{0, 1};
  const auto robot = clearance::make_model<clearance::sphere>(links).on(on);
  const std::vector poses(links.size(), Eigen::Isometry3d::Identity());
  clearance::ask_by(on, robot, poses, points, std::chrono::milliseconds(1), clearance::zones{{0.1}});
}
