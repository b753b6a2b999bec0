// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The header of a PCD file (versions .5 to .7), read strictly: anything not understood is an error that names the line.

#include <clearance/io/cloud.hpp>
#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clearance::io {

struct pcd_field {
  std::string name;
  std::uint64_t size = 4;  // bytes per element
  char type = 'F';         // F float, I signed, U unsigned
  std::uint64_t count = 1;
  std::uint64_t offset = 0;  // bytes before it in a record
  std::uint64_t column = 0;  // words before it in a line
};

struct pcd_header {
  enum class encoding { ascii, binary, binary_compressed };
  std::vector<pcd_field> fields;
  std::array<std::size_t, 3> xyz{};  // indices of these fields
  std::uint64_t record_bytes = 0, record_words = 0;
  std::uint64_t width = 0, height = 1, points = 0;
  std::optional<io::viewpoint> viewpoint;
  encoding data = encoding::ascii;
  std::size_t lines = 0;       // of the header
  bool line_end_left = false;  // the data begin with what may be the end of the header's last line
};

/// Fills in offsets and finds x, y and z. Fields and counts are bounded, so nothing overflows.
inline void lay_out(pcd_header& header, const std::string& file) {
  std::array<int, 3> found{};
  for (std::size_t i = 0; i < header.fields.size(); ++i) {
    auto& field = header.fields[i];
    field.offset = header.record_bytes;
    field.column = header.record_words;
    header.record_bytes += field.size * field.count;
    header.record_words += field.count;
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t at = std::size_t(axis);
      if (field.name != std::string_view("xyz").substr(at, 1) && field.name != std::string_view("XYZ").substr(at, 1))
        continue;  // PDAL writes capitals
      header.xyz[std::size_t(axis)] = i;
      ++found[std::size_t(axis)];
      if (field.count != 1) refuse(file, "field " + field.name + " must have COUNT 1");
    }
  }
  for (int axis = 0; axis < 3; ++axis)
    if (found[std::size_t(axis)] != 1)
      refuse(file, std::string("the PCD header has ") + (found[std::size_t(axis)] ? "more than one" : "no") +
                       " field " + "xyz"[axis]);
}

namespace detail {

/// Reads the entries of a PCD header, one after another.
class pcd_entries {
 public:
  explicit pcd_entries(const std::string& file) : file_(file) {}

  /// Takes one line. Returns true if it was DATA, which ends the header.
  bool take(std::string_view line) {
    ++made.lines;
    const std::string_view key = take_word(line);
    if (key.empty() || key.front() == '#') return false;
    values_ = words(line);
    check_entry(key);
    if (key == "FIELDS" || key == "COLUMNS") take_fields();
    if (key == "SIZE") take_sizes();
    if (key == "TYPE") take_types();
    if (key == "COUNT") take_counts();
    if (key == "WIDTH") made.width = whole(values_[0], 0, most, "WIDTH");
    if (key == "HEIGHT") made.height = whole(values_[0], 0, most, "HEIGHT");
    if (key == "POINTS") made.points = whole(values_[0], 0, most, "POINTS");
    if (key == "VIEWPOINT") take_viewpoint();
    if (key == "DATA") take_encoding();
    return key == "DATA";
  }

  /// Checks, after DATA, that the entries fit together.
  void finish() {
    if (!has("FIELDS") || (made.data != pcd_header::encoding::ascii && !(has("SIZE") && has("TYPE"))))
      refuse(file_, "the PCD header lacks FIELDS, SIZE or TYPE");
    if (!has("WIDTH") && !has("POINTS")) refuse(file_, "the PCD header has neither WIDTH nor POINTS");
    if (!has("WIDTH")) made.width = made.points;  // HEIGHT stays as given, so a contradiction shows below
    if (!has("POINTS")) made.points = made.width * made.height;  // both are below 2^32
    if (made.width * made.height != made.points)
      refuse(file_, "WIDTH " + std::to_string(made.width) + " times HEIGHT " + std::to_string(made.height) +
                        " is not POINTS " + std::to_string(made.points));
    for (const auto& field : made.fields)
      if (field.type == 'F' && field.size < 4)
        refuse(file_, "field " + field.name + " is a float of " + std::to_string(field.size) + " bytes");
    lay_out(made, file_);
  }

  pcd_header made;

 private:
  static constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();  // points, or elements of a field

  bool has(std::string_view key) const { return std::ranges::find(given_, key) != given_.end(); }

  std::uint64_t whole(std::string_view word, std::uint64_t least, std::uint64_t largest, const char* what) const {
    const auto value = number<std::uint64_t>(word);
    if (!value || *value < least || *value > largest)
      refuse(file_, std::string(what) + " " + quoted(word) + " is not a whole number in range", made.lines);
    return *value;
  }

  void check_entry(std::string_view key) {
    constexpr std::string_view known[] = {"VERSION", "FIELDS", "COLUMNS", "SIZE",      "TYPE", "COUNT",
                                          "WIDTH",   "HEIGHT", "POINTS",  "VIEWPOINT", "DATA"};
    if (std::ranges::find(known, key) == std::end(known))
      refuse(file_, quoted(key) + " is no PCD header entry", made.lines);
    if (values_.empty()) refuse(file_, std::string(key) + " has no value", made.lines);
    const std::string_view name = key == "COLUMNS" ? "FIELDS" : key;  // older files say COLUMNS
    if (has(name)) refuse(file_, std::string(name) + " is given twice", made.lines);
    given_.push_back(name);
    constexpr std::string_view lists[] = {"FIELDS", "SIZE", "TYPE", "COUNT", "VIEWPOINT"};
    if (values_.size() > 1 && std::ranges::find(lists, name) == std::end(lists))
      refuse(file_, std::string(key) + " has more than one value", made.lines);
    constexpr std::string_view versions[] = {".5", ".6", ".7", "0.5", "0.6", "0.7"};
    if (key == "VERSION" && std::ranges::find(versions, values_[0]) == std::end(versions))
      refuse(file_, "PCD version " + quoted(values_[0]) + " is not .5, .6 or .7", made.lines);
  }

  template <class Take>
  void for_fields(const char* what, Take take) {
    if (!has("FIELDS")) refuse(file_, std::string(what) + " comes before FIELDS", made.lines);
    if (values_.size() != made.fields.size())
      refuse(file_,
             std::string(what) + " has " + std::to_string(values_.size()) + " entries for " +
                 std::to_string(made.fields.size()) + " fields",
             made.lines);
    for (std::size_t i = 0; i < values_.size(); ++i) take(made.fields[i], values_[i]);
  }

  void take_fields() {
    for (const auto name : values_) made.fields.push_back({.name = std::string(name)});
  }
  void take_sizes() {
    for_fields("SIZE", [&](pcd_field& field, std::string_view word) {
      field.size = whole(word, 1, 8, "SIZE");
      if ((field.size & (field.size - 1)) != 0)
        refuse(file_, "SIZE " + std::string(word) + " is not 1, 2, 4 or 8", made.lines);
    });
  }
  void take_counts() {
    for_fields("COUNT", [&](pcd_field& field, std::string_view word) { field.count = whole(word, 1, most, "COUNT"); });
  }
  void take_types() {
    for_fields("TYPE", [&](pcd_field& field, std::string_view word) {
      if (word != "F" && word != "I" && word != "U")
        refuse(file_, "TYPE " + quoted(word) + " is not F, I or U", made.lines);
      field.type = word[0];
    });
  }
  void take_viewpoint() {
    std::array<double, 7> v{};
    if (values_.size() != v.size()) refuse(file_, "VIEWPOINT needs 7 numbers: tx ty tz qw qx qy qz", made.lines);
    for (std::size_t i = 0; i < v.size(); ++i) {
      const auto value = number<double>(values_[i]);
      if (!value) refuse(file_, "VIEWPOINT has " + quoted(values_[i]) + " for a number", made.lines);
      v[i] = *value;
    }
    made.viewpoint = {{v[0], v[1], v[2]}, Eigen::Quaterniond(v[3], v[4], v[5], v[6])};
  }
  void take_encoding() {
    using enum pcd_header::encoding;
    if (values_[0] != "ascii" && values_[0] != "binary" && values_[0] != "binary_compressed")
      refuse(file_, "DATA " + quoted(values_[0]) + " is not ascii, binary or binary_compressed", made.lines);
    made.data = values_[0] == "ascii" ? ascii : values_[0] == "binary" ? binary : binary_compressed;
  }

  const std::string& file_;
  std::vector<std::string_view> values_, given_;
};

}  // namespace detail

/// Takes the header off `rest`, which leaves the data.
inline pcd_header take_pcd_header(std::string_view& rest, const std::string& file) {
  detail::pcd_entries entries(file);
  const std::string_view all = rest = without_mark(rest);
  while (!rest.empty()) {
    if (!entries.take(take_line(rest))) continue;
    entries.finish();
    const std::size_t behind = rest.size();
    rest = data_after(all, rest);
    entries.made.line_end_left = rest.size() != behind;
    return std::move(entries.made);
  }
  refuse(file, "the PCD header has no DATA entry (is the file cut short, or no PCD?)");
}

}  // namespace clearance::io
