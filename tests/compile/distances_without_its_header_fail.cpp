// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a device is asked with nvcc: include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/volume/sphere.hpp>

// Like clearance::device, so that this also works with a compiler without CUDA.
struct card : clearance::host {
  using own_scan = void;
};

clearance::point_distances ask(const std::vector<std::vector<clearance::inner_sphere>>& bodies,
                               const std::vector<clearance::vec3>& points) {
  return clearance::ask(card{}, clearance::make_model<clearance::sphere>(bodies),
                        std::vector{Eigen::Isometry3d::Identity()}, points, clearance::distances{});
}
