// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a device is asked with nvcc: include <clearance/device.cuh>
#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

// Like clearance::device, so that this also works with a compiler without CUDA.
struct card : clearance::host {
  using own_scan = void;
};

clearance::real ask(const std::vector<clearance::inner_sphere>& spheres, const std::vector<clearance::vec3>& points) {
  const auto part = clearance::make_part(clearance::build<clearance::sphere>(spheres));
  return clearance::ask(card{}, part, Eigen::Isometry3d::Identity(), points, clearance::min_distance{}).distance;
}
