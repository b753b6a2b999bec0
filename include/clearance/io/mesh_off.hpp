// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/mesh_obj.hpp>

namespace clearance::io {

/// Vertices and faces of an OFF file. Colours (COFF, and of faces), normals (NOFF) and texture coordinates (STOFF) are
/// passed over; a line with any other number of numbers may be two, and is refused.
inline polygon_mesh read_off(std::string_view rest, const std::string& file) {
  polygon_mesh mesh;
  std::size_t at = 0;
  const auto next_line = [&](const char* wanted) {  // without comments and blank lines
    while (!rest.empty()) {
      std::string_view line = take_line(rest);
      ++at;
      line = without_comment(line);
      if (line.find_first_not_of(" \t\r\v\f") != line.npos) return line;
    }
    refuse(file, std::string("ends before its ") + wanted);
  };
  const auto count = [&](std::string_view& line, const char* what) {
    const std::string_view word = take_word(line);
    const auto value = number<std::uint64_t>(word);
    if (!value)
      refuse(file, std::string("there is no number of ") + what + ", but \"" + std::string(word.substr(0, 40)) + '"',
             at);
    return *value;
  };

  std::string_view line = next_line("header");
  line.remove_prefix(line.find_first_not_of(" \t\r\v\f"));
  const std::size_t keyword = line.find("OFF");
  const std::string_view prefix = line.substr(0, keyword);
  if (keyword == line.npos || !(prefix.empty() || prefix == "C" || prefix == "N" || prefix == "ST"))
    refuse(file, "is not an OFF file", at);
  line.remove_prefix(keyword + 3);
  if (line.find_first_not_of(" \t\r\v\f") == line.npos) line = next_line("counts");
  const std::uint64_t vertices = count(line, "vertices"), faces = count(line, "faces");
  if (numbers_left(line, file, at) > 1) refuse(file, "has more than three counts", at);  // the third is of edges
  if (vertices > rest.size() || faces > rest.size() || vertices > UINT32_MAX)
    refuse(file,
           "the header says " + std::to_string(vertices) + " vertices and " + std::to_string(faces) +
               " faces, more than the file holds",
           at);
  std::size_t least = prefix == "ST" ? 2 : prefix.empty() ? 0 : 3, most = prefix == "C" ? 4 : least;
  for (std::uint64_t i = 0; i < vertices; ++i) {
    line = next_line("last vertex");
    mesh.vertices.push_back(take_vertex(line, file, at));
    const std::size_t more = numbers_left(line, file, at);
    if (more < least || more > most)
      refuse(file, "a vertex of " + std::to_string(3 + more) + " numbers; the file is " + std::string(prefix) + "OFF",
             at);
    least = most = more;  // all colours have an alpha, or none
  }
  for (std::uint64_t i = 0; i < faces; ++i) {
    line = next_line("last face");
    const std::uint64_t corners = count(line, "corners");
    if (corners < 3 || corners > line.size()) refuse(file, "a face of " + std::to_string(corners) + " corners", at);
    for (std::uint64_t k = 0; k < corners; ++k) {
      const std::uint64_t index = count(line, "a vertex");
      if (index >= vertices)
        refuse(file, "a face has vertex " + std::to_string(index) + ", the file has " + std::to_string(vertices), at);
      mesh.corners.push_back(std::uint32_t(index));
    }
    if (const std::size_t colour = numbers_left(line, file, at); colour == 2 || colour > 4)
      refuse(file, "a face of " + std::to_string(corners) + " corners has " + std::to_string(colour) + " numbers more",
             at);
    mesh.ends.push_back(mesh.corners.size());
  }
  while (!rest.empty()) {
    line = take_line(rest);
    ++at;
    if (line = without_comment(line); line.find_first_not_of(" \t\r\v\f") != line.npos)
      refuse(file, "has more lines than the header's " + std::to_string(faces) + " faces", at);
  }
  return mesh;
}

}  // namespace clearance::io
