// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/mesh_obj.hpp>
#include <clearance/io/ply_check.hpp>

#include <bit>
#include <cstring>

namespace clearance::io {

struct ply_property {
  std::string name, type, count_type;  // count_type: of a list, else empty
};

struct ply_element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<ply_property> properties;
};

/// The values of a PLY file, one after another.
class ply_values {
 public:
  ply_values(std::string_view rest, std::string format, const std::string& file, std::size_t line)
      : rest_(rest), format_(std::move(format)), file_(file), at_(line) {}

  std::size_t left() const { return rest_.size() + line_.size(); }
  bool ascii() const { return format_ == "ascii"; }

  /// In ascii files each record is one line; what is left of the last one is passed over.
  void next_record() {
    for (line_ = {}; ascii() && line_.find_first_not_of(" \t\r") == line_.npos; ++at_) {
      if (rest_.empty()) refuse(file_, "is cut short: a record is missing");
      line_ = take_line(rest_);
    }
  }

  double next(const std::string& type) {
    if (ascii()) {
      const std::string_view word = take_word(line_);
      const auto value = number<double>(word);
      if (word.empty()) refuse(file_, "a record has too few values", at_ - 1);
      if (!value) refuse(file_, "\"" + std::string(word.substr(0, 40)) + "\" is not a number", at_ - 1);
      return *value;
    }
    const std::size_t size = ply_size(type);
    if (rest_.size() < size) refuse(file_, "is cut short: a value is missing");
    char bytes[8];
    for (std::size_t i = 0; i < size; ++i) bytes[i] = rest_[format_ == "binary_big_endian" ? size - 1 - i : i];
    rest_.remove_prefix(size);
    static_assert(std::endian::native == std::endian::little);
    const auto as = [&]<class T>(T value) {
      std::memcpy(&value, bytes, sizeof value);
      return double(value);
    };
    if (type == "float" || type == "float32") return as(float());
    if (type == "double" || type == "float64") return as(double());
    const bool is_unsigned = type.front() == 'u';
    if (size == 1) return is_unsigned ? as(std::uint8_t()) : as(std::int8_t());
    if (size == 2) return is_unsigned ? as(std::uint16_t()) : as(std::int16_t());
    return is_unsigned ? as(std::uint32_t()) : as(std::int32_t());
  }

 private:
  std::string_view rest_, line_;
  std::string format_;
  const std::string& file_;
  std::size_t at_;
};

/// Vertices and faces of a PLY file; other elements and properties are passed over.
inline polygon_mesh read_ply_mesh(std::string_view rest, const std::string& file) {
  std::vector<ply_element> elements;
  std::string format;
  std::size_t at = 1;
  if (take_line(rest) != "ply") refuse(file, "is not a PLY file");
  for (bool ended = false; !ended;) {
    if (rest.empty()) refuse(file, "the PLY header has no end_header (is the file cut short?)");
    const auto line = words(take_line(rest));
    ++at;
    const auto word = [&](std::size_t i) { return i < line.size() ? std::string(line[i]) : std::string(); };
    if (word(0) == "format") {
      format = word(1);
      if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian")
        refuse(file, "the PLY format is not ascii, binary_little_endian or binary_big_endian", at);
    } else if (word(0) == "element") {
      const auto count = number<std::uint64_t>(word(2));
      if (!count) refuse(file, "an element has no count", at);
      for (const auto& other : elements)
        if (other.name == word(1)) refuse(file, "the element " + other.name.substr(0, 40) + " is declared twice", at);
      elements.push_back({word(1), *count, {}});
    } else if (word(0) == "property") {
      const bool list = word(1) == "list";
      const ply_property made{word(list ? 4 : 2), word(list ? 3 : 1), list ? word(2) : ""};
      if (elements.empty() || made.name.empty() || ply_size(made.type) == 0 || (list && ply_size(made.count_type) == 0))
        refuse(file, "a PLY property needs an element before it, a known type and a name", at);
      elements.back().properties.push_back(made);
    } else if (word(0) == "end_header") {
      ended = true;
    } else if (!line.empty() && word(0) != "comment" && word(0) != "obj_info") {
      refuse(file, "\"" + word(0).substr(0, 40) + "\" is no PLY header entry", at);
    }
  }
  if (format.empty()) refuse(file, "the PLY header has no format");

  polygon_mesh mesh;
  ply_values values(rest, format, file, at + 1);
  for (const auto& element : elements) {
    if (element.properties.empty()) continue;
    if (element.count > values.left() || element.count > UINT32_MAX)
      refuse(file, "the header says " + std::to_string(element.count) + " of " + element.name.substr(0, 40) +
                       ", more than the file holds");
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    int axes = 0, lists = 0;
    for (const auto& p : element.properties) {
      axes += is_vertex && p.count_type.empty() && (p.name == "x" || p.name == "y" || p.name == "z");
      lists += is_face && !p.count_type.empty() && (p.name == "vertex_indices" || p.name == "vertex_index");
    }
    if (is_vertex && axes != 3) refuse(file, "PLY vertices need the properties x, y and z, once each");
    if (is_face && lists != 1) refuse(file, "PLY faces need one list vertex_indices");
    for (std::uint64_t i = 0; i < element.count; ++i) {
      values.next_record();
      Eigen::Vector3d v = Eigen::Vector3d::Zero();
      for (const auto& p : element.properties) {
        if (p.count_type.empty()) {
          const double value = values.next(p.type);
          if (is_vertex && (p.name == "x" || p.name == "y" || p.name == "z")) v[p.name[0] - 'x'] = value;
          continue;
        }
        const bool corners = is_face && (p.name == "vertex_indices" || p.name == "vertex_index");
        const double count = values.next(p.count_type);
        if (!(count >= 0 && count <= double(values.left()) && count == std::floor(count)))
          refuse(file, "a list is longer than the file");
        if (corners && count < 3) refuse(file, "face " + std::to_string(i) + " has fewer than three vertices");
        for (std::uint64_t k = 0; k < std::uint64_t(count); ++k) {
          const double index = values.next(p.type);
          if (!corners) continue;
          if (!(index >= 0 && index < 0x1p32 && index == std::floor(index)))
            refuse(file, "face " + std::to_string(i) + " has an impossible vertex");
          mesh.corners.push_back(std::uint32_t(index));
        }
        if (corners) mesh.ends.push_back(mesh.corners.size());
      }
      if (!is_vertex) continue;
      if (!v.allFinite()) refuse(file, "vertex " + std::to_string(i) + " has a coordinate that is not finite");
      mesh.vertices.push_back(v);
    }
  }
  for (const std::uint32_t index : mesh.corners)
    if (index >= mesh.vertices.size())
      refuse(file,
             "a face has vertex " + std::to_string(index) + ", the file has " + std::to_string(mesh.vertices.size()));
  return mesh;
}

}  // namespace clearance::io
