// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Reads a mesh file of any format that robots use.

#include <clearance/io/limits.hpp>
#include <clearance/io/same_eigen.hpp>
#include <clearance/solid/triangle_mesh.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace clearance::io {

/// Which axis of a glTF file is up in the robot's frame. The format says y; many robots' files are made with z.
enum class gltf_axis { y, z };

/// A mesh file's triangles, and what was assumed about it.
struct loaded_mesh {
  triangle_mesh mesh;
  std::string format;                ///< The format's name, as `mesh_format` gives it.
  std::uint64_t bytes = 0;           ///< Bytes read, of this file and of those that it names.
  std::vector<std::string> notes{};  ///< Each continues the file's name: "has ...".

  bool is_gltf() const { return format == "glb" || format == "gltf"; }
};

/// As load_mesh, with notes. Without `up` a glTF file is read as the format has it, y up, and that is noted.
loaded_mesh load_mesh_noted(const std::filesystem::path& path, const mesh_limits& limits = {},
                            std::optional<gltf_axis> up = {});

/// Reads a mesh file: all its meshes, placed by its scene graph, its faces as triangles in their order. In metres, z
/// up: a COLLADA file's unit is honoured, and the axis of a glTF file that `up` names is turned to z. Throws
/// std::runtime_error with a sentence that names the file if it is missing, not a regular file, damaged, beyond a limit
/// or without triangles, if an index is out of range or a coordinate not finite, or if its scene does not place a mesh.
triangle_mesh load_mesh(const std::filesystem::path& path, const mesh_limits& limits = {}, gltf_axis up = gltf_axis::y);

}  // namespace clearance::io
