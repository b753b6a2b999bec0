// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/mesh_dae.hpp>
#include <clearance/io/mesh_obj.hpp>
#include <clearance/io/mesh_off.hpp>
#include <clearance/io/mesh_ply.hpp>
#include <clearance/io/mesh_scene.hpp>
#include <clearance/io/mesh_stl.hpp>

#include <filesystem>
#include <string>

namespace clearance::io {

/// "stl", "obj", "ply", "off", "dae" or "glb", from the file's name, or from its first bytes if the name has no ending.
inline std::string mesh_format(const std::filesystem::path& path, std::string_view bytes) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  for (const char* known : {"stl", "obj", "ply", "off", "dae", "glb"})
    if (ending == std::string(".") + known) return known;
  if (!ending.empty()) refuse(path.string(), "meshes are read from .stl, .obj, .ply, .off, .dae and .glb files");
  if (bytes.starts_with("ply")) return "ply";
  if (bytes.starts_with("OFF")) return "off";
  if (bytes.starts_with("glTF")) return "glb";
  return "stl";
}

/// Reads a mesh file: all its meshes, with the transforms of its scene graph, its faces in their order as triangles.
/// Metres, except that a COLLADA file's unit is honoured. Throws std::runtime_error with a sentence that names the file
/// if it is missing, damaged, has indices out of range or coordinates that are not finite, or has no triangle.
inline triangle_mesh load_mesh(const std::filesystem::path& path) {
  const std::string file = path.string(), bytes = read_bytes(file), format = mesh_format(path, bytes);
  polygon_mesh mesh;
  if (format == "obj") {
    mesh = read_obj(bytes, file);
  } else if (format == "off") {
    mesh = read_off(bytes, file);
  } else if (format == "ply") {
    mesh = read_ply_mesh(bytes, file);
  } else if (format == "stl") {
    if (const std::size_t count = check_stl(bytes, file); count > 0) {
      mesh = read_scene(bytes, format, file);
      if (mesh.ends.size() != count)
        refuse(file, "has " + std::to_string(count) + " triangles, read were " + std::to_string(mesh.ends.size()));
    }
  } else {
    format == "dae" ? check_dae(bytes, file) : check_glb(bytes, file);
    mesh = read_scene(bytes, format, file);
  }
  if (mesh.ends.empty()) refuse(file, "has no triangles");
  return triangulate(std::move(mesh));
}

}  // namespace clearance::io
