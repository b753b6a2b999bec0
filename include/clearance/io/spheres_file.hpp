// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Reads and writes files of spheres: CSV, cuRobo's YAML, or any by the ending of its name.

#include <clearance/io/limits.hpp>
#include <clearance/io/packed_part.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace clearance::io {

/// Reads spheres from a text file: an optional header x,y,z,r, then four numbers per line, metres; # begins a comment.
/// The spheres keep the file's order and have no certificate. Throws std::runtime_error naming file and line.
packing load_spheres_csv(const std::string& file);

/// Saves x,y,z,r with every float exact; the certificate is lost.
void save_spheres_csv(std::span<const inner_sphere> spheres, const std::string& file);

// The YAML files in which cuRobo's users keep a robot's spheres:
//
//   collision_spheres:
//     link_name:
//       - center: [x, y, z]
//         radius: r

/// Reads each link's spheres in the file's order. `collision_spheres` is at the top, or where a cuRobo robot
/// description has it (robot_cfg: kinematics:); a collision_sphere_buffer is added to their radii. They have no
/// certificate. Throws std::runtime_error naming file and line, also for a word that may change the spheres and is not
/// known, and for more values than the limit: each takes about 500 bytes while the file is read. `notes`, if any, go on
/// after the file's name.
std::vector<packed_part> load_spheres_yaml(const std::string& file, const mesh_limits& limits = {},
                                           std::vector<std::string>* notes = nullptr);

/// Saves each link's spheres with every float exact; the certificates are lost. Throws std::runtime_error for a name
/// that is not UTF-8, because YAML would hold another one.
void save_spheres_yaml(std::span<const packed_part> parts, const std::string& file);

/// "ist", "csv" or "yaml" by the ending of the file's name, or empty.
std::string spheres_format(const std::filesystem::path& file);

/// Reads any file of spheres; the part of a CSV file is named after the file. Throws std::runtime_error. `notes`, if
/// any, go on after the file's name.
std::vector<packed_part> load_spheres(const std::string& file, const mesh_limits& limits = {},
                                      std::vector<std::string>* notes = nullptr);

/// Writes the format of the name's ending. Only .ist keeps certificates; a CSV file holds one part. Throws
/// std::runtime_error.
void save_spheres(std::span<const packed_part> parts, const std::string& file);

}  // namespace clearance::io
