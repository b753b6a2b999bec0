// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/backends/host.hpp>
#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/obb.hpp>

#include <cstdio>

int main() {
  const std::vector<clearance::inner_sphere> spheres = {{{0, 0, 0}, 1}, {{0, 0, 2}, 1}, {{0, 0, 4}, 1}};
  const std::vector<clearance::vec3> cloud = {{9, 0, 0}, {0, 2.5f, 4}, {0, 0, 9}};

  const auto part = clearance::make_part(clearance::build<clearance::obb>(spheres));
  const auto r =
      clearance::ask(clearance::host{}, part, Eigen::Isometry3d::Identity(), cloud, clearance::min_distance{});
  std::printf("clearance %d: %g m to point %u\n", CLEARANCE_VERSION, r.distance, unsigned(r.point));
  return r.distance == 1.5f && r.point == 1 ? 0 : 1;
}
