// SPDX-License-Identifier: BSD-3-Clause
// expected-error: deleted
#include <clearance/chunked_query.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

clearance::real far(const std::vector<std::vector<clearance::inner_sphere>>& bodies, clearance::point_span points) {
  clearance::chunked cloud(points);
  const auto made = [&] { return clearance::make_model<clearance::sphere>(bodies); };
  clearance::chunked_query ask(clearance::host{}, made(), clearance::min_distance{});
  return ask(std::vector{Eigen::Isometry3d::Identity()}, cloud).distance;
}
