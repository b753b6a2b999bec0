// SPDX-License-Identifier: BSD-3-Clause
// expected-error: the points of this source stand for more (what they hide, where they may be, how large they are): questions about pairs
#include <clearance/make_model.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/hidden.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/volume/sphere.hpp>

auto ask(const std::vector<std::vector<clearance::inner_sphere>>& bodies,
         const clearance::hidden<clearance::depth_image<float>>& room) {
  return clearance::ask(clearance::host{}, clearance::make_model<clearance::sphere>(bodies),
                        std::vector{Eigen::Isometry3d::Identity()}, room, clearance::distances{});
}
