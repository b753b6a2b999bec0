// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The header of a PCD file (versions .5 to .7), read strictly: what is not understood is an error that names the line.

#include <clearance/io/cloud.hpp>
#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

struct pcd_field {
  std::string name;
  std::uint64_t size = 4;  // bytes of one element
  char type = 'F';         // F float, I signed, U unsigned
  std::uint64_t count = 1;
  std::uint64_t offset = 0;  // bytes before it in a record
  std::uint64_t column = 0;  // words before it in a line
};

struct pcd_header {
  enum class encoding { ascii, binary, binary_compressed };
  std::vector<pcd_field> fields;
  std::array<std::size_t, 3> xyz{};  // which fields
  std::uint64_t record_bytes = 0, record_words = 0;
  std::uint64_t width = 0, height = 1, points = 0;
  std::optional<io::viewpoint> viewpoint;
  encoding data = encoding::ascii;
  std::size_t lines = 0;  // of the header
};

/// Fills in offsets and finds x, y and z. No number here can overflow: fields and counts are bounded.
inline void lay_out(pcd_header& header, const std::string& file) {
  std::array<int, 3> found{};
  for (std::size_t i = 0; i < header.fields.size(); ++i) {
    auto& field = header.fields[i];
    field.offset = header.record_bytes;
    field.column = header.record_words;
    header.record_bytes += field.size * field.count;
    header.record_words += field.count;
    for (int axis = 0; axis < 3; ++axis) {
      if (field.name != std::string_view("xyz").substr(std::size_t(axis), 1)) continue;
      header.xyz[std::size_t(axis)] = i;
      ++found[std::size_t(axis)];
      if (field.count != 1) refuse(file, "field " + field.name + " must have COUNT 1");
    }
  }
  for (int axis = 0; axis < 3; ++axis)
    if (found[std::size_t(axis)] != 1)
      refuse(file, std::string("the PCD header has ") + (found[std::size_t(axis)] ? "more than one" : "no") + " field " +
                       "xyz"[axis]);
}

/// Takes the header off `rest`; what is left is the data.
inline pcd_header take_pcd_header(std::string_view& rest, const std::string& file) {
  pcd_header header;
  const std::string_view all = rest;
  std::vector<std::string_view> given;
  bool has_fields = false, has_size = false, has_type = false, has_width = false, has_points = false;
  const auto whole = [&](std::string_view word, std::uint64_t least, std::uint64_t most, const char* what) {
    const auto value = number<std::uint64_t>(word);
    if (!value || *value < least || *value > most)
      refuse(file, std::string(what) + " " + quoted(word) + " is not a whole number in range",
             header.lines);
    return *value;
  };
  constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();  // points, or elements of a field
  while (!rest.empty()) {
    std::string_view line = take_line(rest);
    ++header.lines;
    const std::string_view key = take_word(line);
    if (key.empty() || key.front() == '#') continue;
    const auto values = words(line);
    const auto each_field = [&](const char* what) {
      if (!has_fields) refuse(file, std::string(what) + " comes before FIELDS", header.lines);
      if (values.size() != header.fields.size())
        refuse(file, std::string(what) + " has " + std::to_string(values.size()) + " entries for " +
                         std::to_string(header.fields.size()) + " fields", header.lines);
    };
    constexpr std::string_view known[] = {"VERSION", "FIELDS", "COLUMNS", "SIZE", "TYPE", "COUNT",
                                          "WIDTH", "HEIGHT", "POINTS", "VIEWPOINT", "DATA"};
    if (std::find(std::begin(known), std::end(known), key) == std::end(known))
      refuse(file, quoted(key) + " is no PCD header entry", header.lines);
    if (values.empty()) refuse(file, std::string(key) + " has no value", header.lines);
    if (std::find(given.begin(), given.end(), key) != given.end())
      refuse(file, std::string(key) + " is given twice", header.lines);
    given.push_back(key);
    constexpr std::string_view lists[] = {"FIELDS", "COLUMNS", "SIZE", "TYPE", "COUNT", "VIEWPOINT"};
    if (values.size() > 1 && std::find(std::begin(lists), std::end(lists), key) == std::end(lists))
      refuse(file, std::string(key) + " has more than one value", header.lines);
    if (key == "VERSION") {
      constexpr std::string_view versions[] = {".5", ".6", ".7", "0.5", "0.6", "0.7"};
      if (std::find(std::begin(versions), std::end(versions), values[0]) == std::end(versions))
        refuse(file, "PCD version " + quoted(values[0]) + " is not .5, .6 or .7", header.lines);
    } else if (key == "FIELDS" || key == "COLUMNS") {
      if (has_fields) refuse(file, "FIELDS is given twice", header.lines);
      has_fields = true;
      for (const auto name : values) header.fields.push_back({.name = std::string(name)});
    } else if (key == "SIZE") {
      each_field("SIZE");
      has_size = true;
      for (std::size_t i = 0; i < values.size(); ++i) {
        header.fields[i].size = whole(values[i], 1, 8, "SIZE");
        if ((header.fields[i].size & (header.fields[i].size - 1)) != 0)
          refuse(file, "SIZE " + std::string(values[i]) + " is not 1, 2, 4 or 8", header.lines);
      }
    } else if (key == "TYPE") {
      each_field("TYPE");
      has_type = true;
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i] != "F" && values[i] != "I" && values[i] != "U")
          refuse(file, "TYPE " + quoted(values[i]) + " is not F, I or U", header.lines);
        header.fields[i].type = values[i][0];
      }
    } else if (key == "COUNT") {
      each_field("COUNT");
      for (std::size_t i = 0; i < values.size(); ++i) header.fields[i].count = whole(values[i], 1, most, "COUNT");
    } else if (key == "WIDTH") {
      header.width = whole(values[0], 0, most, "WIDTH");
      has_width = true;
    } else if (key == "HEIGHT") {
      header.height = whole(values[0], 0, most, "HEIGHT");
    } else if (key == "POINTS") {
      header.points = whole(values[0], 0, most, "POINTS");
      has_points = true;
    } else if (key == "VIEWPOINT") {
      std::array<double, 7> v{};
      if (values.size() != v.size()) refuse(file, "VIEWPOINT needs 7 numbers: tx ty tz qw qx qy qz", header.lines);
      for (std::size_t i = 0; i < v.size(); ++i) {
        const auto value = number<double>(values[i]);
        if (!value) refuse(file, "VIEWPOINT has " + quoted(values[i]) + " for a number", header.lines);
        v[i] = *value;
      }
      header.viewpoint = {{v[0], v[1], v[2]}, Eigen::Quaterniond(v[3], v[4], v[5], v[6])};
    } else {  // DATA
      if (values[0] == "ascii") header.data = pcd_header::encoding::ascii;
      else if (values[0] == "binary") header.data = pcd_header::encoding::binary;
      else if (values[0] == "binary_compressed") header.data = pcd_header::encoding::binary_compressed;
      else refuse(file, "DATA " + quoted(values[0]) + " is not ascii, binary or binary_compressed", header.lines);
      if (!has_fields || (header.data != pcd_header::encoding::ascii && !(has_size && has_type)))
        refuse(file, "the PCD header lacks FIELDS, SIZE or TYPE");
      if (!has_width && !has_points) refuse(file, "the PCD header has neither WIDTH nor POINTS");
      if (!has_width) header.width = header.points;  // and HEIGHT as given, so that a contradiction shows below
      if (!has_points) header.points = header.width * header.height;  // both are below 2^32
      if (header.width * header.height != header.points)
        refuse(file, "WIDTH " + std::to_string(header.width) + " times HEIGHT " + std::to_string(header.height) +
                         " is not POINTS " + std::to_string(header.points));
      for (const auto& field : header.fields)
        if (field.type == 'F' && field.size < 4)
          refuse(file, "field " + field.name + " is a float of " + std::to_string(field.size) + " bytes");
      lay_out(header, file);
      rest = data_after(all, rest);
      return header;
    }
  }
  refuse(file, "the PCD header has no DATA entry (is the file cut short, or no PCD?)");
}

}  // namespace clearance::io
