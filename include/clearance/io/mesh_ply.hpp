// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/mesh_polygons.hpp>
#include <clearance/io/ply_values.hpp>

namespace clearance::io {

namespace detail {

inline bool lists_corners(const ply_element& element, const ply_property& p) {
  return element.name == "face" && p.count && (p.name == "vertex_indices" || p.name == "vertex_index");
}

/// Refuses faces without corners, and geometry that this reader would pass over.
inline void check_ply_faces(const ply_header& header, const std::string& file) {
  for (const auto& element : header.elements) {
    if (element.name == "tristrips" && element.count > 0) refuse(file, "has triangle strips, which are not supported");
    if (element.name != "face") continue;
    const auto is_list = [&](const ply_property& p) { return lists_corners(element, p); };
    const auto list = std::ranges::find_if(element.properties, is_list);
    if (std::ranges::count_if(element.properties, is_list) != 1 || !is_whole(list->type))
      refuse(file, "PLY faces need one list vertex_indices of a whole type");
  }
}

}  // namespace detail

/// Vertices, in double, and faces of a PLY file; other elements and properties are checked and passed over.
inline polygon_mesh read_ply_mesh(std::string_view rest, const std::string& file) {
  const ply_header header = take_ply_header(rest, file);
  detail::check_ply_faces(header, file);
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
        if (!detail::lists_corners(element, p)) return;
        if (listed.size() < 3) refuse(file, at.record() + " has fewer than three vertices", at.line());
        for (const double index : listed) {
          if (!(index >= 0 && index < double(count)))
            refuse(file,
                   at.record() + " has vertex " + std::to_string((long long)index) + ", the file has " +
                       std::to_string(count),
                   at.line());
          mesh.corners.push_back(std::uint32_t(index));
        }
        mesh.ends.push_back(mesh.corners.size());
      });
  return mesh;
}

}  // namespace clearance::io
