// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What must hold of a PLY file before assimp reads its points. assimp 5.2 invents points where a file is cut short,
// loses its place when the first data byte equals a line end, and crashes on some damaged headers; none of that with
// what passes here.

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>

#include <cstdint>
#include <string>
#include <string_view>

namespace clearance::io {

/// A PLY file cut down to its vertices, with an orderly header.
struct ply_vertices {
  std::uint64_t count = 0;
  bool doubles = false;  // are x, y or z doubles?
  std::string bytes;     // for assimp
};

/// Bytes of a scalar PLY type, 0 if it is none.
constexpr std::uint64_t ply_size(std::string_view type) {
  if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
  if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
  if (type == "int" || type == "uint" || type == "float" || type == "int32" || type == "uint32" || type == "float32") return 4;
  return type == "double" || type == "float64" ? 8 : 0;
}

/// Checks the header and that all vertices are there. The vertices must be the first element, without lists.
inline ply_vertices check_ply(std::string_view rest, const std::string& file) {
  ply_vertices made;
  std::uint64_t record_bytes = 0, record_words = 0;
  std::size_t at = 1;
  int elements = 0;
  std::string found, format;
  if (take_line(rest) != "ply") refuse(file, "is not a PLY file");
  for (bool ended = false; !ended;) {
    if (rest.empty()) refuse(file, "the PLY header has no end_header (is the file cut short?)");
    std::string_view line = take_line(rest);
    const std::string text(line);
    ++at;
    const auto key = take_word(line);
    const auto values = words(line);
    const auto value = [&](std::size_t i) { return i < values.size() ? values[i] : std::string_view(); };
    if (key == "format") {
      format = value(0);
      if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian")
        refuse(file, "the PLY format is not ascii, binary_little_endian or binary_big_endian", at);
      made.bytes = "ply\nformat " + format + " 1.0\n";
    } else if (key == "element") {
      const auto count = number<std::uint64_t>(value(1));
      if (!count) refuse(file, "an element has no count", at);
      if (++elements == 1) {
        if (value(0) != "vertex") refuse(file, "the first element of a PLY point cloud must be vertex", at);
        made.count = *count;
        made.bytes += "element vertex " + std::to_string(*count) + '\n';
      }
    } else if (key == "property") {
      const bool list = value(0) == "list";
      const std::uint64_t size = ply_size(value(list ? 2 : 0));
      if (elements == 0 || size == 0 || value(list ? 3 : 1).empty() || (list && ply_size(value(1)) == 0))
        refuse(file, "a PLY property needs an element before it, a known type and a name", at);
      if (elements != 1) continue;
      if (list) refuse(file, "vertices with lists are not supported", at);
      record_bytes += size;
      ++record_words;
      if (value(1) == "x" || value(1) == "y" || value(1) == "z") {
        found += value(1);
        made.doubles = made.doubles || size == 8;
        made.bytes += "property " + std::string(value(0)) + ' ' + std::string(value(1)) + '\n';
      } else {  // by a name that means nothing to assimp: no colour or normal can then be wrong
        made.bytes += "property " + std::string(value(0)) + " unused" + std::to_string(record_words) + '\n';
      }
    } else if (key == "end_header") {
      ended = true;
    } else if (key != "comment" && key != "obj_info" && !key.empty()) {
      refuse(file, quoted(key) + " is no PLY header entry", at);
    }
  }
  if (format.empty()) refuse(file, "the PLY header has no format");
  if (made.count == 0) return made;
  std::sort(found.begin(), found.end());
  if (found != "xyz") refuse(file, "PLY vertices need the properties x, y and z, once each");
  if (made.count > rest.size() / (format == "ascii" ? 2 * record_words - 1 : record_bytes))
    refuse(file, "the header says " + std::to_string(made.count) + " vertices, more than the file holds");
  if (format == "ascii") {
    made.bytes += "end_header\n";
    for (std::uint64_t i = 0; i < made.count;) {
      if (rest.empty())
        refuse(file, "the header says " + std::to_string(made.count) + " vertices, the file ends after " + std::to_string(i));
      const auto values = words(take_line(rest));
      ++at;
      if (values.empty()) continue;
      if (values.size() != record_words)
        refuse(file, "a vertex needs " + std::to_string(record_words) + " values, here are " + std::to_string(values.size()), at);
      for (const auto word : values) {
        if (!number<double>(word)) refuse(file, quoted(word) + " is not a number", at);
        made.bytes.append(word).push_back(' ');
      }
      made.bytes.back() = '\n';
      ++i;
    }
  } else {
    made.bytes += "end_header\r\n";  // after these two, assimp takes the next byte as data, whatever it is
    made.bytes += rest.substr(0, made.count * record_bytes);
  }
  return made;
}

}  // namespace clearance::io
