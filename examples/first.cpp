// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/backends/host.hpp>
#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

int main() {
  // A link of a robot, filled with spheres, in its own frame; and where the link is now. Metres.
  const std::vector<clearance::inner_sphere> link = {{{0, 0, 0}, 0.10f}, {{0, 0, 0.15f}, 0.08f}, {{0, 0, 0.3f}, 0.05f}};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // world from link
  pose.translation() << 0, 0, 0.5;

  // What the sensor sees in this frame, in world coordinates.
  const std::vector<clearance::vec3> cloud = {{0.4f, 0, 0.5f}, {0, 0.2f, 0.8f}, {0, 0, 1.2f}};

  const clearance::host cpu;
  const auto part = clearance::make_part(clearance::build<clearance::sphere>(link));  // once
  const auto r = clearance::ask(cpu, part, pose, cloud, clearance::min_distance{});   // in every frame

  std::printf("%s: %.4f m from sphere %u to point %u\n", clearance::to_string(r.state), r.distance, r.primitive,
              r.point);
  std::printf("nearest on the robot: (%.3f, %.3f, %.3f)\n", r.nearest.x, r.nearest.y, r.nearest.z);
  return r.point == 1 && r.lower > 0.149f && r.upper < 0.151f ? 0 : 1;
}
