// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/pcd.hpp>
#include <clearance/io/ply.hpp>
#include <clearance/io/xyz.hpp>

#include <algorithm>
#include <filesystem>

namespace clearance::io {

/// The ending of a file's name in small letters, with its dot.
inline std::string extension(const std::string& file) {
  std::string end = std::filesystem::path(file).extension().string();
  std::transform(end.begin(), end.end(), end.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return end;
}

/// Reads a point cloud by the ending of its name: .pcd, .ply, .xyz or .txt. Throws std::runtime_error.
inline cloud load_cloud(const std::string& file, const read_limits& limits = {}) {
  const std::string end = extension(file);
  if (end == ".pcd") return within_memory(file, [&] { return load_pcd(file, limits); });
  if (end == ".ply") return within_memory(file, [&] { return load_ply(file, limits); });
  if (end == ".xyz" || end == ".txt") return within_memory(file, [&] { return load_xyz(file, limits); });
  refuse(file, "is no point cloud by its name: .pcd, .ply, .xyz and .txt are read");
}

}  // namespace clearance::io
