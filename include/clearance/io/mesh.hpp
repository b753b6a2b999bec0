// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/mesh_dae.hpp>
#include <clearance/io/mesh_glb.hpp>
#include <clearance/io/mesh_obj.hpp>
#include <clearance/io/mesh_off.hpp>
#include <clearance/io/mesh_ply.hpp>
#include <clearance/io/mesh_stl.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

namespace clearance::io {

/// "stl", "obj", "ply", "off", "dae" or "glb", from the file's name, or from its first bytes if the name has no ending.
inline std::string mesh_format(const std::filesystem::path& path, std::string_view bytes) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  for (const char* known : {"stl", "obj", "ply", "off", "dae", "glb"})
    if (ending == std::string(".") + known) return known;
  if (!ending.empty()) refuse(path.string(), "meshes are read from .stl, .obj, .ply, .off, .dae and .glb files");
  if (bytes.starts_with("ply") || bytes.starts_with("PLY")) return "ply";
  if (bytes.starts_with("OFF")) return "off";
  if (bytes.starts_with("glTF")) return "glb";
  return "stl";
}

/// Reads a mesh file: all its meshes, placed by its scene graph, its faces as triangles in their order. In metres; a
/// COLLADA file's unit is honoured. Throws std::runtime_error with a sentence that names the file if it is missing, not
/// a regular file, damaged, beyond a limit or without triangles, if an index is out of range or a coordinate not
/// finite, or if its scene does not place a mesh.
inline triangle_mesh load_mesh(const std::filesystem::path& path, const mesh_limits& limits = {}) {
  const std::string file = path.string();
  return within_memory(file, [&] {
    std::error_code failed;
    const auto there = std::filesystem::status(path, failed);
    if (std::filesystem::exists(there) && !std::filesystem::is_directory(there)) {
      if (!std::filesystem::is_regular_file(there))
        refuse(file, "is no regular file, and meshes are only read from those");
      if (std::filesystem::file_size(path, failed) > limits.bytes)
        refuse(file, "is longer than the " + std::to_string(limits.bytes) +
                         " bytes that the limit leaves (mesh_limits::bytes)");
    }
    const std::string bytes = read_bytes(file), format = mesh_format(path, without_mark(bytes));
    polygon_mesh mesh = format == "obj"   ? read_obj(without_mark(bytes), file)
                        : format == "off" ? read_off(without_mark(bytes), file)
                        : format == "ply" ? read_ply_mesh(bytes, file)
                        : format == "stl" ? read_stl(bytes, file)
                        : format == "dae" ? read_dae(bytes, file, limits)
                                          : read_glb(bytes, file, limits);
    if (mesh.ends.empty()) refuse(file, "has no triangles");
    if (mesh.corners.size() - 2 * mesh.ends.size() > limits.triangles)
      refuse(file, "has more than the " + std::to_string(limits.triangles) +
                       " triangles that the limit leaves (mesh_limits::triangles)");
    return triangulate(std::move(mesh), file);
  });
}

}  // namespace clearance::io
