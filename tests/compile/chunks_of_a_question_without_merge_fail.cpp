// SPDX-License-Identifier: BSD-3-Clause
// expected-error: this question cannot be asked about pieces of the clouds (several devices, chunks, ranks, a deadline)
#include <clearance/chunked_query.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/volume/sphere.hpp>

clearance::real far(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  clearance::chunked cloud(points);
  clearance::chunked_query ask(clearance::host{}, robot, clearance::min_distance_supported{});
  return ask(std::vector{Eigen::Isometry3d::Identity()}, cloud).distance;
}
