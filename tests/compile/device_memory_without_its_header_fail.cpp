// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a device keeps its memory otherwise: include the question's .cuh header, not the .hpp
#include <clearance/bvh/build.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/primitive/inner_sphere.hpp>
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
