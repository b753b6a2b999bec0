// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Files that the command reads beside a robot's description, with notes that begin with the file's name.

#include <clearance/io/mesh.hpp>
#include <clearance/io/sentence.hpp>
#include <clearance/io/spheres_file.hpp>

#include <optional>
#include <string>
#include <vector>

inline void add_notes(const std::string& file, const std::vector<std::string>& more, std::vector<std::string>& notes) {
  for (const std::string& note : more) notes.push_back(clearance::io::sentence_about(file, note));
}

inline clearance::triangle_mesh noted_mesh(const std::string& file, const clearance::io::mesh_limits& limits,
                                           std::optional<clearance::io::gltf_axis> up,
                                           std::vector<std::string>& notes) {
  clearance::io::loaded_mesh read = clearance::io::load_mesh_noted(file, limits, up);
  add_notes(file, read.notes, notes);
  return std::move(read.mesh);
}

inline std::vector<clearance::io::packed_part> noted_spheres(const std::string& file,
                                                             const clearance::io::mesh_limits& limits,
                                                             std::vector<std::string>& notes) {
  std::vector<std::string> more;
  auto parts = clearance::io::load_spheres(file, limits, &more);
  add_notes(file, more, notes);
  return parts;
}
