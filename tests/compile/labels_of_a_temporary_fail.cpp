// SPDX-License-Identifier: BSD-3-Clause
// expected-error: deleted
#include <clearance/make_model.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/unseen.hpp>
#include <clearance/volume/sphere.hpp>

clearance::unseen hidden(const std::vector<std::vector<clearance::inner_sphere>>& bodies,
                         const clearance::depth_image<float>& image) {
  const auto robot = clearance::make_model<clearance::sphere>(bodies);
  const std::vector poses{Eigen::Isometry3d::Identity()};
  return {.labels = clearance::ask(clearance::host{}, robot, poses, image, clearance::self_filter{}).labels};
}
