// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace clearance {

/// Triangles over shared vertices, in metres in the part's own frame; in double, as read from a file or made in code.
struct triangle_mesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// First triangle of each shape in the part; empty: it is one shape. Each shape is closed separately.
  std::vector<std::uint32_t> shapes = {};
};

}  // namespace clearance
