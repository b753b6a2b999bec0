// SPDX-License-Identifier: BSD-3-Clause
// expected-error: several clouds are a vector or a tuple of placed ones, and one may be followed by its pose
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

clearance::real ask(const std::vector<std::vector<clearance::inner_sphere>>& bodies,
                    const std::vector<clearance::vec3>& points) {
  const clearance::point_span span(points);
  return clearance::ask(clearance::host{}, clearance::make_model<clearance::sphere>(bodies),
                        std::vector{Eigen::Isometry3d::Identity()}, span, span, clearance::min_distance{})
      .distance;
}
