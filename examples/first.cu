// SPDX-License-Identifier: BSD-3-Clause
// first.cpp on a GPU: three lines differ.
#include <clearance/bvh/build.hpp>
#include <clearance/device.cuh>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

int main() {
  const std::vector<clearance::inner_sphere> link = {{{0, 0, 0}, 0.10f}, {{0, 0, 0.15f}, 0.08f}, {{0, 0, 0.3f}, 0.05f}};
  const std::vector<clearance::vec3> cloud = {{0.4f, 0, 0}, {0, 0.2f, 0.3f}, {0, 0, 0.7f}};
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();

  // [device]
  const clearance::device gpu{.id = 0};  // and .stream, if it is to be one of yours
  const auto part = clearance::make_part(clearance::build<clearance::sphere>(link)).on(gpu);
  const auto r = clearance::ask(gpu, part, pose, cloud, clearance::min_distance{});
  // [device]
  return r.point == 1 && r.lower > 0.149f && r.upper < 0.151f ? 0 : 1;
}
