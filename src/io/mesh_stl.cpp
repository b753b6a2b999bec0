// SPDX-License-Identifier: BSD-3-Clause
// Reads the triangles of an STL file, ASCII or binary.

#include "io/mesh_formats.hpp"
#include "io/mesh_polygons.hpp"

#include <clearance/io/bytes.hpp>
#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/text_file.hpp>

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

namespace {

polygon_mesh read_ascii_stl(std::string_view rest, const std::string& file) {
  polygon_mesh mesh;
  std::size_t at = 0;
  std::string_view line;

  const auto next = [&] {  // the next word in small letters; empty at the file's end
    std::string_view word;
    while ((word = take_word(line)).empty() && !rest.empty()) {
      line = take_line(rest);
      ++at;
    }
    std::string small(word);
    for (char& c : small) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
    return small;
  };
  const auto expect = [&](const char* wanted) {
    if (const std::string got = next(); got != wanted)
      refuse(file,
             std::string("expected \"") + wanted + "\", " +
                 (got.empty() ? "but the file ends" : "found " + io::quoted(got)),
             at);
  };
  const auto three_numbers = [&](bool normal) {
    Eigen::Vector3d v;
    for (double& x : v) {
      const std::string word = next();
      const auto value = number<double>(word);
      const bool none = normal && word.find(".#") != word.npos;  // "-1.#IND", of old runtimes
      if (!value && !none) refuse(file, "expected a number, found " + io::quoted(word), at);
      x = value.value_or(0);
    }
    return v;
  };

  for (std::string word = next(); !word.empty(); word = next()) {
    if (word != "solid") refuse(file, "expected \"solid\", found " + io::quoted(word), at);
    line = {};  // its name
    for (word = next(); word != "endsolid"; word = next()) {
      if (word != "facet")
        refuse(
            file,
            "expected \"facet\" or \"endsolid\", " + (word.empty() ? "but the file ends" : "found " + io::quoted(word)),
            at);
      expect("normal");
      three_numbers(true);  // which may be anything
      expect("outer");
      expect("loop");
      for (int i = 0; i < 3; ++i) {
        expect("vertex");
        mesh.corners.push_back(std::uint32_t(mesh.vertices.size()));
        mesh.vertices.push_back(three_numbers(false));
        if (!mesh.vertices.back().allFinite()) refuse(file, "a vertex has a coordinate that is not finite", at);
      }
      mesh.ends.push_back(mesh.corners.size());
      expect("endloop");
      expect("endfacet");
    }
    line = {};
  }
  return mesh;
}

/// `count` triangles after the header of 84 bytes.
polygon_mesh read_binary_stl(std::string_view bytes, std::uint64_t count, const std::string& file) {
  polygon_mesh mesh;
  if (count > UINT32_MAX / 3) refuse(file, "has more vertices than can be counted");
  byte_reader reader(bytes.substr(84), file);
  mesh.vertices.reserve(3 * count);
  for (std::uint64_t t = 0; t < count; ++t) {
    reader.take(12);  // its normal
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d v;
      for (double& x : v) x = double(reader.take<float>());
      if (!v.allFinite()) refuse(file, "triangle " + std::to_string(t) + " has a coordinate that is not finite");
      mesh.corners.push_back(std::uint32_t(mesh.vertices.size()));
      mesh.vertices.push_back(v);
    }
    mesh.ends.push_back(mesh.corners.size());
    reader.take(2);  // flags
  }
  return mesh;
}

}  // namespace

polygon_mesh read_stl(std::string_view bytes, const std::string& file, std::vector<std::string>& notes) {
  const std::uint64_t count = bytes.size() < 84 ? 0 : byte_reader(bytes.substr(80, 4), file).take<std::uint32_t>();
  if (bytes.size() >= 84 && bytes.size() == 84 + 50 * count)  // even where the header says "solid"
    return read_binary_stl(bytes, count, file);
  const bool wide = bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF") ||
                    bytes.starts_with(std::string_view("s\0o\0", 4));
  const std::string converted = wide ? as_utf8(std::string(bytes), file) : std::string();
  const std::string_view text = wide ? std::string_view(converted) : without_mark(bytes);
  const std::string_view start = text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  const bool says_solid = start.starts_with("solid") || start.starts_with("SOLID") || start.starts_with("Solid");
  if (says_solid && text.find('\0') == text.npos) return read_ascii_stl(text, file);
  if (bytes.size() < 84) refuse(file, "is shorter than the 84 bytes that begin a binary STL file");
  if (const std::uint64_t more = bytes.size() - 84 - 50 * count;
      count > 0 && bytes.size() > 84 + 50 * count && more < 50) {
    notes.push_back("has bytes after its last triangle, fewer than a triangle takes, which are passed over");
    return read_binary_stl(bytes, count, file);
  }
  refuse(file, "as a binary STL file of " + std::to_string(count) + " triangles it would have " +
                   std::to_string(84 + 50 * count) + " bytes, but it has " + std::to_string(bytes.size()));
}

}  // namespace clearance::io
