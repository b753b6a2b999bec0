// SPDX-License-Identifier: BSD-3-Clause
// expected-error: the points of this source stand for more (what they hide, where they may be, how large they are): questions about pairs
#include <clearance/make_model.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance_filtered.hpp>
#include <clearance/volume/sphere.hpp>

auto ask(const std::vector<clearance::inner_sphere>& body, const std::vector<clearance::vec3>& points) {
  const clearance::uncertain source(clearance::point_span(points), clearance::lidar_noise{0.02f});
  const auto model = clearance::make_model<clearance::sphere>(std::vector<std::vector<clearance::inner_sphere>>{body});
  const std::vector poses{Eigen::Isometry3d::Identity()};
  return clearance::min_distance_filtered(clearance::host{}, model, poses, source);
}
