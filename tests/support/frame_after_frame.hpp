// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include <vector>

namespace testing {

/// Calls `same(when)` for what a prepared question says cold, warm, after `poses` have moved, and after `forget()`.
template <class Same, class Forget>
void frame_after_frame(std::vector<Eigen::Isometry3d>& poses, const Same& same, const Forget& forget) {
  same("cold");
  same("warm");
  poses[0].translation().x() += 0.01;
  same("moved a little");
  poses.back().translation().z() -= 5;
  same("moved far");
  forget();
  same("cold again");
}

}  // namespace testing
