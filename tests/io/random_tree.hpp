// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Random trees with joints of every kind, some of which follow others.

#include "support/random.hpp"

#include <clearance/io/kinematics.hpp>

namespace testing {

/// `links` links with origins within `reach` of their parents', and a configuration.
inline std::pair<clearance::io::kinematic_tree, std::vector<double>> random_tree(dice& d, std::size_t links,
                                                                                 double reach) {
  using namespace clearance::io;
  std::vector<std::string> names{"l0"};
  std::vector<joint> joints;
  for (std::size_t i = 1; i < links; ++i) {
    joint j;
    j.name = "j" + std::to_string(i), j.parent = names[i < 4 ? i - 1 : i - 1 - d.below(3)],
    j.child = "l" + std::to_string(i);
    j.kind = joint_kind(i % 4 == 0 ? d.below(4) : 1 + d.below(3));
    j.origin = d.pose(reach);
    const clearance::vec3 axis = d.direction();
    j.axis = 2 * Eigen::Vector3d(axis.x, axis.y, axis.z);
    if (i % 3 == 0 && joints[i - 2].kind != joint_kind::fixed)
      j.follows = mimic{joints[i - 2].name, d.uniform(-2, 2), d.uniform(-0.3, 0.3)};
    names.push_back(j.child);
    joints.push_back(j);
  }
  kinematic_tree tree(names, joints);
  std::vector<double> q;
  for (std::size_t i = 0; i < tree.size(); ++i)
    q.push_back(tree.movable(i).kind == joint_kind::prismatic ? d.uniform(-0.3, 0.3) : d.uniform(-3, 3));
  return {tree, q};
}

}  // namespace testing
