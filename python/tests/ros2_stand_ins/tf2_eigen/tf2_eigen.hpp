// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace tf2 {
inline Eigen::Isometry3d transformToEigen(const Eigen::Isometry3d& transform) { return transform; }
}  // namespace tf2
