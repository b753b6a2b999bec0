// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/bvh/build.hpp>
#include <clearance/device.cuh>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/obb.hpp>

// Not called: the machine that builds this need not have a GPU.
float distance_on_device(const clearance::device& gpu, const std::vector<clearance::inner_sphere>& spheres,
                         const std::vector<clearance::vec3>& cloud) {
  const auto part = clearance::make_part(clearance::build<clearance::obb>(spheres)).on(gpu);
  return clearance::ask(gpu, part, Eigen::Isometry3d::Identity(), cloud, clearance::min_distance{}).distance;
}
