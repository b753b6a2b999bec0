// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Closed meshes in their poses: nested boxes, a globe, a ring, and one that is inside out.

#include "solid/shapes.hpp"
#include "support/random.hpp"

#include <clearance/solid/close_mesh.hpp>

namespace testing {

struct closed_parts {
  std::vector<clearance::closed_mesh> meshes;
  std::vector<Eigen::Isometry3d> poses;
};

inline closed_parts closed_scene(unsigned seed) {
  dice d(seed);
  closed_parts all;
  for (const auto& mesh :
       {shapes::merged(shapes::box({-0.3, -0.2, -0.2}, {0.3, 0.2, 0.2}), shapes::box({0, -0.1, -0.3}, {0.5, 0.1, 0.1})),
        shapes::globe({0.1, 0, 0}, 0.3), shapes::inverted(shapes::torus(0.3, 0.1, 24, 12))}) {
    all.meshes.push_back(clearance::close_mesh(mesh));
    all.poses.push_back(d.pose(0.4));
  }
  return all;
}

}  // namespace testing
