// SPDX-License-Identifier: BSD-3-Clause
// expected-error: the points of this source stand for more
#include <clearance/make_model.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/volume/sphere.hpp>

auto ask(const std::vector<std::vector<clearance::inner_sphere>>& bodies, const std::vector<clearance::vec3>& points) {
  const clearance::uncertain source(clearance::point_span(points), clearance::lidar_noise{0.02f});
  return clearance::ask(clearance::host{}, clearance::make_model<clearance::sphere>(bodies),
                        std::vector{Eigen::Isometry3d::Identity()}, source, clearance::self_filter{});
}
