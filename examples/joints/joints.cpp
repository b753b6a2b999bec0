// SPDX-License-Identifier: BSD-3-Clause
// From parts to joints: which joint moves the arm away from what is near, and is the way there free?
#include <clearance/io/jacobian.hpp>
#include <clearance/io/joint_motion.hpp>
#include <clearance/make_model.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

int main() {
  // Two hinges about z, 0.4 m apart; `load_robot` reads such a tree, and the links' shapes, from a file.
  using clearance::io::joint;
  joint shoulder, elbow;
  shoulder.name = "shoulder", shoulder.parent = "base", shoulder.child = "upper";
  elbow.name = "elbow", elbow.parent = "upper", elbow.child = "fore";
  elbow.origin.translation().x() = 0.4;
  for (joint* j : {&shoulder, &elbow})
    j->kind = clearance::io::joint_kind::revolute, j->axis = Eigen::Vector3d::UnitZ();
  const clearance::io::kinematic_tree tree({"base", "upper", "fore"}, {shoulder, elbow});
  const std::vector<std::size_t> links{1, 2};  // of the parts
  std::vector<std::vector<clearance::inner_sphere>> bodies(2);
  for (auto& body : bodies)
    for (int i = 0; i <= 20; ++i) body.push_back({{0.02f * float(i), 0, 0}, 0.03f});
  const auto arm = clearance::make_model<clearance::sphere>(bodies);
  const std::vector<clearance::vec3> points{{0.5f, 0.3f, 0}};
  const clearance::host on;

  // [gradient]
  const std::vector<double> q{0.2, 0.4};
  const auto link_poses = tree.link_poses(q);
  const std::vector poses{link_poses[links[0]], link_poses[links[1]]};
  const auto near = clearance::ask(on, arm, poses, points, clearance::min_distance{});
  const auto g = clearance::gradient(near, Eigen::Vector3d(poses[near.part].translation()));
  const auto by_joints = clearance::io::joint_gradient(tree, link_poses, links[near.part], g);
  if (!by_joints) return std::printf("no gradient: %s\n", to_string(g.state)), 1;
  std::printf("%.3f m; shoulder %+.3f m/rad, elbow %+.3f m/rad\n", double(near.distance), (*by_joints)[0],
              (*by_joints)[1]);
  // [gradient]

  // [motion]
  const auto way = [&](double shoulder_to, double elbow_to) {
    const clearance::io::joint_motion motion(tree, links, q, std::vector{shoulder_to, elbow_to});
    return clearance::motion_clearance(on, arm, motion, points, {.tolerance = 0.002, .margin = 0.02});
  };
  const auto away = way(-0.5, 0.4), through = way(1.2, 0.4);
  std::printf("away: %s, at least %.3f m; through: %s at time %.2f\n", to_string(away.state), double(away.lower),
              to_string(through.state), through.time);
  // [motion]
  return (*by_joints)[0] < 0 && away.state == clearance::state::free && through.state == clearance::state::collision
             ? 0
             : 1;
}
