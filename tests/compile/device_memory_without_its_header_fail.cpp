// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a device is asked with nvcc: include <clearance/device.cuh>
#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/volume/sphere.hpp>

// Like clearance::device, so that this also works with a compiler without CUDA.
struct card : clearance::host {
  using own_scan = void;
};

std::size_t ask(const std::vector<clearance::inner_sphere>& spheres, const std::vector<clearance::vec3>& points) {
  const clearance::model robot{std::vector{clearance::make_part(clearance::build<clearance::sphere>(spheres))}};
  const std::vector<clearance::part_minimum> minima(1);
  const std::vector<Eigen::Isometry3d> poses(1, Eigen::Isometry3d::Identity());
  return clearance::ask(card{}, robot, poses, points, clearance::part_witnesses{minima}).size();
}
