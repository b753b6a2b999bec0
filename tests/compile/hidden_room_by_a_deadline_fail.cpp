// SPDX-License-Identifier: BSD-3-Clause
// expected-error: what pixels hide is asked about as a whole: not in chunks, by a deadline or on several devices
// and no other error
#include <clearance/deadline.hpp>
#include <clearance/make_model.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/hidden.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

void ask(const std::vector<std::vector<clearance::inner_sphere>>& links,
         const clearance::hidden<clearance::depth_image<float>>& room) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  const std::vector poses(robot.size(), Eigen::Isometry3d::Identity());
  clearance::ask_by(clearance::host{}, robot, poses, room, std::chrono::milliseconds(1), clearance::zones{{0.1}});
}
