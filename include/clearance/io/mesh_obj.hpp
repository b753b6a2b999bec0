// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Mesh readers are our own: assimp 5.2 loses triangle order among materials, refuses ".8e-1", reads "1.#IND" as 1, drops
// what it does not understand, and hangs or crashes on damaged files. These keep doubles too.

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/mesh_polygons.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace clearance::io {

/// Reads x, y and z from the words of a line, or ends with a sentence.
inline Eigen::Vector3d take_vertex(std::string_view& line, const std::string& file, std::size_t at) {
  Eigen::Vector3d v;
  for (double& x : v) {
    const std::string_view word = take_word(line);
    const auto value = number<double>(word);
    if (word.empty()) refuse(file, "a vertex has fewer than three coordinates", at);
    if (!value) refuse(file, "\"" + std::string(word.substr(0, 40)) + "\" is not a number", at);
    if (!std::isfinite(*value)) refuse(file, "a vertex has a coordinate that is not finite", at);
    x = *value;
  }
  return v;
}

/// How many words are left of a line, up to a comment. All must be numbers, "nan" too, or it ends with a sentence.
inline std::size_t numbers_left(std::string_view line, const std::string& file, std::size_t at) {
  std::size_t count = 0;
  for (auto word = take_word(line); !word.empty() && word.front() != '#'; word = take_word(line), ++count)
    if (!number<double>(word)) refuse(file, quoted(word) + " is not a number", at);
  return count;
}

/// Is this the first word of an OBJ statement? Of all that the format has, and skin weights, which some tools add.
inline bool obj_statement(std::string_view word) {
  for (const std::string_view known :
       {"v",        "vt",       "vn",         "vp",        "vw",     "f",      "l",      "p",     "g",
        "o",        "s",        "usemtl",     "mtllib",    "usemap", "maplib", "mg",     "bevel", "lod",
        "c_interp", "d_interp", "shadow_obj", "trace_obj", "cstype", "deg",    "bmat",   "step",  "curv",
        "curv2",    "surf",     "parm",       "trim",      "hole",   "scrv",   "sp",     "end",   "con",
        "ctech",    "stech",    "call",       "csh",       "bsp",    "bzp",    "cdc",    "cdp",   "res"})
    if (word == known) return true;
  return false;
}

/// The vertex of a face's corner "1", "1/2", "1//3" or "1/2/3"; nothing if that is not what it is.
inline std::optional<std::int64_t> obj_corner(std::string_view word) {
  std::optional<std::int64_t> vertex;
  for (int k = 0; k < 3; ++k) {  // its texture and its normal are passed over
    const std::size_t end = std::min(word.find('/'), word.size());
    const std::string_view one = word.substr(0, end);
    const auto value = number<std::int64_t>(one);
    if (k == 0) vertex = value;
    if (!value && (k == 0 || !one.empty())) return std::nullopt;
    if (end == word.size()) return vertex;
    word.remove_prefix(end + 1);
  }
  return std::nullopt;
}

/// One that is passed over and holds no name. If another begins in its line, a line end was lost.
inline bool obj_of_numbers(std::string_view key) {
  return key == "vn" || key == "vt" || key == "vp" || key == "s" || key == "l" || key == "p";
}

/// Vertices and faces of a Wavefront OBJ file; normals, materials, groups, lines and points are passed over, and so is
/// what stands before the first vertex. A later line that is no statement may be what is left of a face: an error.
inline polygon_mesh read_obj(std::string_view rest, const std::string& file) {
  polygon_mesh mesh;
  if (rest.find('\0') != rest.npos) refuse(file, "is not an OBJ file: it has zero bytes, so it is not plain text");
  std::uint32_t largest = 0;
  std::size_t largest_at = 0;
  std::string joined;
  for (std::size_t at = 1; !rest.empty(); ++at) {
    const std::size_t first = at;
    std::string_view line = take_line(rest);
    if (line.ends_with('\\')) {  // goes on in the next line
      joined.clear();
      for (; line.ends_with('\\') && !rest.empty(); ++at, line = take_line(rest))
        joined.append(line.substr(0, line.size() - 1)).push_back(' ');
      joined.append(line);
      line = joined;
    }
    const std::string_view key = take_word(line);
    if (key == "v") {
      mesh.vertices.push_back(take_vertex(line, file, first));
      const std::size_t more = numbers_left(line, file, first);  // a weight, a colour, or both
      if (more != 0 && more != 1 && more != 3 && more != 4)
        refuse(file, "a vertex of " + std::to_string(3 + more) + " numbers", first);
    } else if (key == "f") {
      const std::size_t begin = mesh.corners.size();
      for (auto word = take_word(line); !word.empty() && word.front() != '#'; word = take_word(line)) {
        const auto given = obj_corner(word);
        const std::int64_t count = std::int64_t(mesh.vertices.size());
        const std::int64_t index = !given       ? 0
                                   : *given < 0 ? *given + count + 1
                                                : *given;  // from 1; negative: from the end
        if (index < 1 || index > std::int64_t(UINT32_MAX))
          refuse(file, "\"" + std::string(word.substr(0, 40)) + "\" is no vertex of a face", first);
        if (index > largest) largest = std::uint32_t(index), largest_at = first;
        mesh.corners.push_back(std::uint32_t(index - 1));
      }
      if (mesh.corners.size() < begin + 3) refuse(file, "a face has fewer than three vertices", first);
      mesh.ends.push_back(mesh.corners.size());
    } else if (obj_of_numbers(key)) {
      for (auto word = take_word(line); !word.empty() && word.front() != '#'; word = take_word(line))
        if (obj_statement(word)) refuse(file, quoted(word) + " begins a second statement in the line", first);
    } else if (!mesh.vertices.empty() && !key.empty() && key.front() != '#' && !obj_statement(key)) {
      refuse(file, quoted(key) + " begins no statement of an OBJ file", first);
    }
  }
  if (largest > mesh.vertices.size())
    refuse(file,
           "a face has vertex " + std::to_string(largest) + ", the file has " + std::to_string(mesh.vertices.size()),
           largest_at);
  return mesh;
}

}  // namespace clearance::io
