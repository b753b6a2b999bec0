// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/ist.hpp>
#include <clearance/io/spheres_csv.hpp>
#include <clearance/io/spheres_yaml.hpp>

#include <filesystem>

namespace clearance::io {

/// "ist", "csv" or "yaml" by the ending of the file's name, or empty.
inline std::string spheres_format(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  return ending == ".ist" ? "ist" : ending == ".csv" ? "csv" : ending == ".yaml" || ending == ".yml" ? "yaml" : "";
}

/// Reads any file of spheres; the part of a CSV file is named after the file. Throws std::runtime_error.
inline std::vector<packed_part> load_spheres(const std::string& file, const mesh_limits& limits = {}) {
  const std::string format = spheres_format(file);
  if (format == "ist") return load_ist(file);
  if (format == "yaml") return load_spheres_yaml(file, limits);
  if (format != "csv") refuse(file, "spheres are read from .ist, .csv, .yaml and .yml files");
  std::vector<packed_part> parts(1);
  parts[0].name = std::filesystem::path(file).stem().string();
  parts[0].spheres = load_spheres_csv(file);
  return parts;
}

/// Writes the format of the name's ending. Only .ist keeps certificates; a CSV file holds one part. Throws
/// std::runtime_error.
inline void save_spheres(std::span<const packed_part> parts, const std::string& file) {
  const std::string format = spheres_format(file);
  if (format == "ist") return save_ist(parts, file);
  if (format == "yaml") return save_spheres_yaml(parts, file);
  if (format != "csv") refuse(file, "spheres are written to .ist, .csv, .yaml and .yml files");
  if (parts.size() != 1)
    refuse(file, "a CSV file holds the spheres of one part, here are " + std::to_string(parts.size()) +
                     ": take .ist or .yaml");
  save_spheres_csv(parts[0].spheres.spheres, file);
}

}  // namespace clearance::io
