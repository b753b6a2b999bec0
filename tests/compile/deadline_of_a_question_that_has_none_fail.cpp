// SPDX-License-Identifier: BSD-3-Clause
// expected-error: while points are unseen this question has no answer: it needs so_far(result&, std::uint64_t unseen)
#include <clearance/deadline.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/volume/sphere.hpp>

std::size_t near(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  return clearance::ask_by(clearance::host{}, robot, std::vector{Eigen::Isometry3d::Identity()}, points,
                           std::chrono::milliseconds(1), clearance::nearest_k{3})
      .unseen;
}
