// SPDX-License-Identifier: BSD-3-Clause
// expected-error: unseen is asked about depth_image and ray_image, or masked, cropped or uncertain ones
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/unseen.hpp>
#include <clearance/volume/sphere.hpp>

auto ask(const std::vector<std::vector<clearance::inner_sphere>>& bodies, const std::vector<clearance::vec3>& points) {
  return clearance::ask(clearance::host{}, clearance::make_model<clearance::sphere>(bodies),
                        std::vector{Eigen::Isometry3d::Identity()}, points, clearance::unseen{});
}
