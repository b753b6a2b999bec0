// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/cloud.hpp>
#include <clearance/io/ply_values.hpp>

namespace clearance::io {

/// Reads a PLY file from memory; `file` is its name in the cloud and in errors.
inline cloud read_ply(std::string_view rest, const std::string& file) {
  const ply_header header = take_ply_header(rest, file);
  if (!header.elements.empty() && !header.find("vertex")) refuse(file, "a PLY point cloud needs the element vertex");
  std::vector<Eigen::Vector3d> points;
  read_ply_values(
      rest, header, file, [&](const ply_values&, const double* p) { points.emplace_back(p[0], p[1], p[2]); },
      [](const auto&...) {});
  return make_cloud(file, points, points.size(), 1);
}

/// Reads the vertices of a PLY file, ascii or binary, in the file's order, in double. Everything else is checked and
/// skipped. Throws std::runtime_error with a sentence if a value does not fit its type, or a count does not fit the
/// data.
inline cloud load_ply(const std::string& file, const read_limits& limits = {}) {
  return read_ply(read_bytes(file, limits), file);
}

}  // namespace clearance::io
