// SPDX-License-Identifier: BSD-3-Clause
// Reads the mesh of an OFF file.

#include "io/mesh_formats.hpp"

#include <clearance/io/cloud_text.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace clearance::io {

namespace {

/// The lines of an OFF file, without comments and blank lines.
struct off_lines {
  std::string_view rest;
  const std::string& file;
  std::size_t at = 0;  ///< The number of the last line taken.

  /// No value at the end of the file.
  std::optional<std::string_view> next() {
    while (!rest.empty()) {
      const std::string_view line = without_comment(take_line(rest));
      ++at;
      if (const std::size_t first = line.find_first_not_of(" \t\r\v\f"); first != line.npos) return line.substr(first);
    }
    return std::nullopt;
  }
  std::string_view next(const char* wanted) {
    if (const auto line = next()) return *line;
    io::refuse(file, std::string("ends before its ") + wanted);
  }
  [[noreturn]] void refuse(const std::string& why) const { io::refuse(file, why, at); }
  std::uint64_t count(std::string_view& line, const char* what) const {
    const std::string_view word = take_word(line);
    if (const auto value = number<std::uint64_t>(word)) return *value;
    refuse(std::string("there is no number of ") + what + ", but \"" + std::string(word.substr(0, 40)) + '"');
  }
};

/// The word before OFF: nothing, C, N or ST. `line` becomes what follows OFF.
std::string_view take_off_keyword(off_lines& lines, std::string_view& line) {
  line = lines.next("header");
  const std::size_t keyword = line.find("OFF");
  const std::string_view prefix = line.substr(0, keyword);
  if (keyword == line.npos || !(prefix.empty() || prefix == "C" || prefix == "N" || prefix == "ST"))
    lines.refuse("is not an OFF file");
  line.remove_prefix(keyword + 3);
  return prefix;
}

void take_off_vertices(off_lines& lines, std::string_view prefix, std::uint64_t count, polygon_mesh& mesh) {
  std::size_t least = prefix == "ST" ? 2 : prefix.empty() ? 0 : 3, most = prefix == "C" ? 4 : least;
  for (std::uint64_t i = 0; i < count; ++i) {
    std::string_view line = lines.next("last vertex");
    mesh.vertices.push_back(take_vertex(line, lines.file, lines.at));
    const std::size_t more = numbers_left(line, lines.file, lines.at);
    if (more < least || more > most)
      lines.refuse("a vertex of " + std::to_string(3 + more) + " numbers; the file is " + std::string(prefix) + "OFF");
    least = most = more;  // either all colours have an alpha, or none
  }
}

void take_off_face(off_lines& lines, polygon_mesh& mesh) {
  std::string_view line = lines.next("last face");
  const std::uint64_t corners = lines.count(line, "corners"), vertices = mesh.vertices.size();
  if (corners < 3 || corners > line.size()) lines.refuse("a face of " + std::to_string(corners) + " corners");
  for (std::uint64_t k = 0; k < corners; ++k) {
    const std::uint64_t index = lines.count(line, "a vertex");
    if (index >= vertices)
      lines.refuse("a face has vertex " + std::to_string(index) + ", the file has " + std::to_string(vertices));
    mesh.corners.push_back(std::uint32_t(index));
  }
  if (const std::size_t colour = numbers_left(line, lines.file, lines.at); colour == 2 || colour > 4)
    lines.refuse("a face of " + std::to_string(corners) + " corners has " + std::to_string(colour) + " numbers more");
  mesh.ends.push_back(mesh.corners.size());
}

}  // namespace

polygon_mesh read_off(std::string_view rest, const std::string& file) {
  off_lines lines{rest, file};
  std::string_view line;
  const std::string_view prefix = take_off_keyword(lines, line);
  if (line.find_first_not_of(" \t\r\v\f") == line.npos) line = lines.next("counts");
  const std::uint64_t vertices = lines.count(line, "vertices"), faces = lines.count(line, "faces");
  if (numbers_left(line, file, lines.at) > 1) lines.refuse("has more than three counts");  // the third counts edges
  if (vertices > lines.rest.size() || faces > lines.rest.size() || vertices > UINT32_MAX)
    lines.refuse("the header says " + std::to_string(vertices) + " vertices and " + std::to_string(faces) +
                 " faces, more than the file holds");
  polygon_mesh mesh;
  take_off_vertices(lines, prefix, vertices, mesh);
  for (std::uint64_t i = 0; i < faces; ++i) take_off_face(lines, mesh);
  if (lines.next()) lines.refuse("has more lines than the header's " + std::to_string(faces) + " faces");
  return mesh;
}

}  // namespace clearance::io
