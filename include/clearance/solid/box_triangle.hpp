// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace clearance {

/// Does a triangle, even one without area, touch the cube of half side `half` around `middle`? By separating axes:
/// those of the cube, the triangle's normal, and the nine products of their edges (Akenine-Moeller 2001).
inline bool box_meets_triangle(const Eigen::Vector3d& middle, double half,
                               const std::array<Eigen::Vector3d, 3>& corners) {
  const Eigen::Vector3d v[3] = {corners[0] - middle, corners[1] - middle, corners[2] - middle};
  for (int k = 0; k < 3; ++k)
    if (std::min({v[0][k], v[1][k], v[2][k]}) > half || std::max({v[0][k], v[1][k], v[2][k]}) < -half) return false;
  const Eigen::Vector3d edge[3] = {v[1] - v[0], v[2] - v[1], v[0] - v[2]};
  const Eigen::Vector3d normal = edge[0].cross(edge[1]);
  if (std::abs(normal.dot(v[0])) > half * normal.cwiseAbs().sum()) return false;
  for (int e = 0; e < 3; ++e)
    for (int k = 0; k < 3; ++k) {  // the axis edge x unit vector k
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      const double p[3] = {edge[e][b] * v[0][a] - edge[e][a] * v[0][b], edge[e][b] * v[1][a] - edge[e][a] * v[1][b],
                           edge[e][b] * v[2][a] - edge[e][a] * v[2][b]};
      const double reach = half * (std::abs(edge[e][a]) + std::abs(edge[e][b]));
      if (std::min({p[0], p[1], p[2]}) > reach || std::max({p[0], p[1], p[2]}) < -reach) return false;
    }
  return true;
}

}  // namespace clearance
