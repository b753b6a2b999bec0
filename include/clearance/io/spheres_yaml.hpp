// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The YAML files in which cuRobo's users keep a robot's spheres:
//
//   collision_spheres:
//     link_name:
//       - center: [x, y, z]
//         radius: r

#include <clearance/io/limits.hpp>
#include <clearance/io/packed_part.hpp>

#include <span>
#include <string>
#include <vector>

namespace clearance::io {

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

}  // namespace clearance::io
