// SPDX-License-Identifier: BSD-3-Clause
// Reads the mesh of a PLY file, faces and triangle strips.

#include "io/mesh_formats.hpp"
#include "io/mesh_polygons.hpp"
#include "io/ply_values.hpp"

namespace clearance::io {

namespace {

bool names_vertices(const ply_property& p) {
  return p.count && (p.name == "vertex_indices" || p.name == "vertex_index");
}

bool holds_faces(const ply_element& element) { return element.name == "face" || element.name == "tristrips"; }

/// Refuses faces without corners, and geometry that this reader would skip.
void check_ply_faces(const ply_header& header, const std::string& file) {
  for (const auto& element : header.elements) {
    const auto list = std::ranges::find_if(element.properties, names_vertices);
    const auto lists = std::ranges::count_if(element.properties, names_vertices);
    if (!holds_faces(element) && lists > 0 && element.count > 0)
      refuse(file, "has the element " + io::quoted(element.name) + " with " + io::quoted(list->name) +
                       ", which is not known: faces are read from \"face\" and \"tristrips\"");
    if (!holds_faces(element)) continue;
    if (lists != 1 || !is_whole(list->type)) refuse(file, "PLY faces need one list vertex_indices of a whole type");
  }
}

/// Adds the faces of triangle strips; -1 ends a strip. Every second triangle of a strip is turned round. Returns false
/// if a strip has only one or two vertices.
bool add_strips(polygon_mesh& mesh, const std::vector<double>& listed) {
  std::size_t begin = 0;  // of the strip
  for (std::size_t i = 0; i <= listed.size(); ++i) {
    if (i == listed.size() || listed[i] == -1) {
      if (i - begin == 1 || i - begin == 2) return false;
      begin = i + 1;
    } else if (i >= begin + 2) {
      const std::size_t odd = (i - begin) % 2;
      for (const std::size_t k : {i - 2 + odd, i - 1 - odd, i}) mesh.corners.push_back(std::uint32_t(listed[k]));
      mesh.ends.push_back(mesh.corners.size());
    }
  }
  return true;
}

}  // namespace

polygon_mesh read_ply_mesh(std::string_view rest, const std::string& file) {
  const ply_header header = take_ply_header(rest, file);
  check_ply_faces(header, file);
  const ply_element* vertices = header.find("vertex");
  const std::uint64_t count = vertices ? vertices->count : 0;
  if (count > UINT32_MAX) refuse(file, "has more vertices than can be counted");

  polygon_mesh mesh;
  read_ply_values(
      rest, header, file,
      [&](const ply_values& at, const double* p) {
        mesh.vertices.emplace_back(p[0], p[1], p[2]);
        if (!mesh.vertices.back().allFinite())
          refuse(file, at.record() + " has a coordinate that is not finite", at.line());
      },
      [&](const ply_element& element, const ply_property& p, const ply_values& at, const std::vector<double>& listed) {
        if (!holds_faces(element) || !names_vertices(p)) return;
        const bool strips = element.name == "tristrips";
        const auto too_few = [&] { refuse(file, at.record() + " has fewer than three vertices", at.line()); };
        if (listed.size() < 3) too_few();
        for (const double index : listed) {
          if (strips && index == -1) continue;
          if (!(index >= 0 && index < double(count)))
            refuse(file,
                   at.record() + " has vertex " + std::to_string((long long)index) + ", the file has " +
                       std::to_string(count),
                   at.line());
          if (!strips) mesh.corners.push_back(std::uint32_t(index));
        }
        if (!strips) mesh.ends.push_back(mesh.corners.size());
        if (strips && !add_strips(mesh, listed)) too_few();
      });
  return mesh;
}

}  // namespace clearance::io
