// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/mesh.hpp>

#include "io/gltf_data.hpp"
#include "io/mesh_formats.hpp"

#include <clearance/io/text_file.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace clearance::io {

namespace {

/// Says how a glTF file is read if nobody said how; it goes on after the file's name.
constexpr const char* gltf_note =
    "is glTF, and read with y up, as the format has it; --gltf-up z (gltf_up) is for one that was made with z up";

/// The position that robots, whose z is up, give to a position of glTF.
Eigen::Vector3d from_gltf(const Eigen::Vector3d& p, gltf_axis up) {
  return up == gltf_axis::z ? p : Eigen::Vector3d(p.x(), -p.z(), p.y());
}

/// "stl", "obj", "ply", "off", "dae", "glb" or "gltf", from the file's name, or from its first bytes if the name has no
/// ending.
std::string mesh_format(const std::filesystem::path& path, std::string_view bytes) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  for (const char* known : {"stl", "obj", "ply", "off", "dae", "glb", "gltf"})
    if (ending == std::string(".") + known) return known;
  if (!ending.empty()) refuse(path.string(), "meshes are read from .stl, .obj, .ply, .off, .dae, .glb and .gltf files");
  if (bytes.starts_with("ply") || bytes.starts_with("PLY")) return "ply";
  if (bytes.starts_with("OFF")) return "off";
  if (bytes.starts_with("glTF")) return "glb";
  return "stl";
}

}  // namespace

loaded_mesh load_mesh_noted(const std::filesystem::path& path, const mesh_limits& limits, std::optional<gltf_axis> up) {
  const std::string file = path.string();
  return within_memory(file, [&] {
    std::error_code failed;
    const auto status = std::filesystem::status(path, failed);
    if (std::filesystem::exists(status) && !std::filesystem::is_directory(status)) {
      if (!std::filesystem::is_regular_file(status))
        refuse(file, "is no regular file, and meshes are only read from those");
      if (std::filesystem::file_size(path, failed) > limits.bytes)
        refuse(file, "is longer than the " + std::to_string(limits.bytes) +
                         " bytes that the limit leaves (mesh_limits::bytes)");
    }

    std::string bytes = read_bytes(file);
    loaded_mesh made{.mesh = {}, .format = mesh_format(path, without_mark(bytes)), .bytes = bytes.size()};
    const std::string& format = made.format;
    if (format == "obj" || format == "off" || format == "ply" || format == "gltf")
      bytes = as_utf8(std::move(bytes), file);
    mesh_limits left = limits;
    left.bytes -= std::min(left.bytes, made.bytes);

    std::uint64_t others = 0;
    const auto gltf = [&] {
      const glb_chunks chunks = format == "glb" ? read_glb_chunks(bytes, file) : glb_chunks{without_mark(bytes), {}};
      return read_gltf(chunks.json, chunks.data, file, left, made.notes, others);
    };
    polygon_mesh mesh = format == "obj"   ? read_obj(without_mark(bytes), file)
                        : format == "off" ? read_off(without_mark(bytes), file)
                        : format == "ply" ? read_ply_mesh(bytes, file)
                        : format == "stl" ? read_stl(bytes, file, made.notes)
                        : format == "dae" ? read_dae(bytes, file, limits, made.notes)
                                          : gltf();

    made.bytes += others;
    if (mesh.ends.empty()) refuse(file, "has no triangles");
    if (mesh.corners.size() - 2 * mesh.ends.size() > limits.triangles)
      refuse(file, "has more than the " + std::to_string(limits.triangles) +
                       " triangles that the limit leaves (mesh_limits::triangles)");
    if (made.is_gltf())
      for (auto& v : mesh.vertices) v = from_gltf(v, up.value_or(gltf_axis::y));
    if (made.is_gltf() && !up) made.notes.push_back(gltf_note);
    made.mesh = triangulate(std::move(mesh), file);
    return made;
  });
}

triangle_mesh load_mesh(const std::filesystem::path& path, const mesh_limits& limits, gltf_axis up) {
  return load_mesh_noted(path, limits, up).mesh;
}

}  // namespace clearance::io
