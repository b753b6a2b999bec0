// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The header of a PLY file, read strictly: anything not understood is an error that names the line.

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

enum class ply_type : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

constexpr std::size_t ply_size(ply_type type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[std::size_t(type)];
}
constexpr bool is_whole(ply_type type) { return type < ply_type::float32; }

inline std::optional<ply_type> ply_type_of(std::string_view name) {
  constexpr std::string_view old_names[] = {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"};
  constexpr std::string_view new_names[] = {"int8",  "uint8",  "int16",   "uint16",
                                            "int32", "uint32", "float32", "float64"};
  for (std::size_t k = 0; k < 8; ++k)
    if (name == old_names[k] || name == new_names[k]) return ply_type(k);
  return std::nullopt;
}

struct ply_property {
  std::string name;
  ply_type type;
  std::optional<ply_type> count;  // of a list
};

struct ply_element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<ply_property> properties;
};

struct ply_header {
  enum class encoding { none, ascii, little_endian, big_endian };
  encoding format = encoding::none;
  std::vector<ply_element> elements;
  std::size_t lines = 0;

  /// The element with this name, or null.
  const ply_element* find(std::string_view name) const {
    for (const auto& each : elements)
      if (each.name == name) return &each;
    return nullptr;
  }
};

namespace detail {

/// The names that were declared: elements, and properties of the last one.
struct ply_names {
  std::set<std::string_view> elements, properties;
};

inline void take_ply_element(ply_header& header, ply_names& names, const std::vector<std::string_view>& line,
                             const std::string& file) {
  const auto count = line.size() == 3 ? number<std::uint64_t>(line[2]) : std::nullopt;
  if (!count) refuse(file, "an element of a PLY header needs a name and a count", header.lines);
  if (!names.elements.insert(line[1]).second)
    refuse(file, "the element " + quoted(line[1]) + " is declared twice", header.lines);
  header.elements.push_back({std::string(line[1]), *count, {}});
  names.properties.clear();
}

inline void take_ply_property(ply_header& header, ply_names& names, const std::vector<std::string_view>& line,
                              const std::string& file) {
  const bool list = line.size() > 1 && line[1] == "list";
  if (line.size() != (list ? 5 : 3) || header.elements.empty())
    refuse(file, "a PLY property needs an element before it, a known type and a name", header.lines);
  const auto type = ply_type_of(line[list ? 3 : 1]), count = list ? ply_type_of(line[2]) : std::nullopt;
  if (!type || (list && !count))
    refuse(file, "a PLY property needs an element before it, a known type and a name", header.lines);
  if (count && !is_whole(*count)) refuse(file, "the count of a PLY list must be of a whole type", header.lines);
  if (!names.properties.insert(line.back()).second)
    refuse(file, "the property " + quoted(line.back()) + " is declared twice", header.lines);
  header.elements.back().properties.push_back({std::string(line.back()), *type, count});
}

}  // namespace detail

/// Takes the header off `rest`, which leaves the data.
inline ply_header take_ply_header(std::string_view& rest, const std::string& file) {
  ply_header header;
  detail::ply_names names;
  const std::string_view all = rest = without_mark(rest);
  if (const auto first = take_line(rest); first != "ply" && first != "PLY") refuse(file, "is not a PLY file");
  for (header.lines = 1; !rest.empty();) {
    const auto line = words(take_line(rest));
    ++header.lines;
    if (line.empty() || line[0] == "comment" || line[0] == "obj_info") continue;
    if (line.size() > 1 && line[0] == "Created" && line[1] == "by") continue;  // an old Blender forgot "comment"
    if (line[0] == "format") {
      using enum ply_header::encoding;
      const std::string_view name = line.size() == 3 ? line[1] : "";
      if (header.format != none) refuse(file, "the PLY format is given twice", header.lines);
      header.format = name == "ascii"                  ? ascii
                      : name == "binary_little_endian" ? little_endian
                      : name == "binary_big_endian"    ? big_endian
                                                       : none;
      if (header.format == none || line[2] != "1.0")
        refuse(file, "the PLY format is not ascii, binary_little_endian or binary_big_endian 1.0", header.lines);
    } else if (line[0] == "element") {
      detail::take_ply_element(header, names, line, file);
    } else if (line[0] == "property") {
      detail::take_ply_property(header, names, line, file);
    } else if (line[0] == "end_header" && line.size() == 1) {
      if (header.format == ply_header::encoding::none) refuse(file, "the PLY header has no format");
      rest = data_after(all, rest);
      return header;
    } else {
      refuse(file, quoted(line[0]) + " is no PLY header entry", header.lines);
    }
  }
  refuse(file, "the PLY header has no end_header (is the file cut short?)");
}

}  // namespace clearance::io
