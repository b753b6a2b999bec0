// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The mesh formats, one reader each: they take a file's bytes, and its name for error sentences.

#include "io/mesh_polygons.hpp"

#include <clearance/io/limits.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

/// Reads x, y and z from the words of a line; throws if it cannot.
Eigen::Vector3d take_vertex(std::string_view& line, const std::string& file, std::size_t at);

/// The number of words left in a line, up to a comment. Throws unless all are numbers ("nan" is one).
std::size_t numbers_left(std::string_view line, const std::string& file, std::size_t at);

/// Vertices and faces of a Wavefront OBJ file. Normals, materials, groups, lines, points, and counts before the first
/// vertex are skipped. A face of one or two corners becomes a triangle without area. A line that is no statement may be
/// the rest of a face, so it is an error; so are free-form surfaces.
polygon_mesh read_obj(std::string_view rest, const std::string& file);

/// Vertices and faces of an OFF file. Colours (COFF, and of faces), normals (NOFF) and texture coordinates (STOFF) are
/// skipped. A line with another number of numbers may be two lines in one, so it is refused.
polygon_mesh read_off(std::string_view rest, const std::string& file);

/// Vertices, in double, and faces of a PLY file, including triangle strips. Other elements and properties are checked
/// and skipped.
polygon_mesh read_ply_mesh(std::string_view rest, const std::string& file);

/// All triangles of an ASCII or binary STL file, which must be complete. Less than a triangle may follow the last one
/// of a binary file, with a note, which goes on after the file's name.
polygon_mesh read_stl(std::string_view bytes, const std::string& file, std::vector<std::string>& notes);

/// All meshes of a COLLADA file's scene, once for each place that the scene gives them. The file's unit counts; its up
/// axis does not, as in ROS tools. Notes go on after the file's name.
polygon_mesh read_dae(std::string_view bytes, const std::string& file, const mesh_limits& limits,
                      std::vector<std::string>& notes);

/// All meshes of a glTF file's scene, once for each place that the scene gives them, as the file has them: unturned.
/// `text` is its JSON. Notes go on after the file's name.
polygon_mesh read_gltf(std::string_view text, std::optional<std::string_view> chunk, const std::string& file,
                       const mesh_limits& limits, std::vector<std::string>& notes, std::uint64_t& bytes_of_others);

}  // namespace clearance::io
