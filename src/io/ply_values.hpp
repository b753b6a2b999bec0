// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What all readers of PLY files share: the header, and the values, each checked against it.

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>

#include <bit>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clearance::io {

// The header of a PLY file, read strictly: anything not understood is an error that names the line.

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
  const std::string_view whole = rest = without_mark(rest);
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
      rest = data_after(whole, rest);
      return header;
    } else {
      refuse(file, quoted(line[0]) + " is no PLY header entry", header.lines);
    }
  }
  refuse(file, "the PLY header has no end_header (is the file cut short?)");
}

/// The values of a PLY file in turn, each checked against its type. A double holds a number of any PLY type without
/// loss.
class ply_values {
 public:
  ply_values(std::string_view rest, const ply_header& header, const std::string& file)
      : rest_(rest), file_(file), format_(header.format), at_(header.lines) {}

  /// Refuses a count of records for which the file is too short.
  void expect(const ply_element& element) const {
    std::size_t least = 0;  // bytes per record
    for (const auto& p : element.properties) least += ascii() ? 2 : ply_size(p.count.value_or(p.type));
    if (least > 0 && element.count > (rest_.size() + 1) / least)
      refuse(file_, "the header says " + std::to_string(element.count) + " of " + io::quoted(element.name) +
                        ", more than the file holds (is it cut short?)");
  }

  /// Goes to record `number` of an element. In text each record has its own line; blank lines do not count.
  void begin(const ply_element& element, std::uint64_t number) {
    element_ = &element;
    number_ = number;
    if (!ascii()) return;
    do {
      if (rest_.empty())
        refuse(file_, "the header says " + std::to_string(element.count) + " of " + io::quoted(element.name) +
                          ", the file ends after " + std::to_string(number) + " (is it cut short?)");
      line_ = take_line(rest_);
      ++at_;
    } while (blank(line_));
  }
  void end() const {
    if (!blank(line_)) refuse(file_, record() + " has more values than the header says", at_);
  }

  double next(ply_type type) { return ascii() ? spelt(type) : packed(type); }

  /// The number of values in the list that comes next.
  std::uint64_t list(const ply_property& p) {
    const double count = next(*p.count);
    if (!(count >= 0)) refuse(file_, record() + " has a list of " + std::to_string((long long)count), line());
    if (count > double(left()) / double(ascii() ? 1 : ply_size(p.type)))
      refuse(file_, record() + " has a list that is longer than the file", line());
    return std::uint64_t(count);
  }

  /// Refuses anything after the last element.
  void finish() const {
    if (ascii() ? !blank(rest_, " \t\r\n\v\f") : !rest_.empty())
      refuse(file_,
             "has more data than its header says, after " +
                 (element_ ? "the last of " + io::quoted(element_->name) : std::string("the header")),
             ascii() ? at_ + 1 : 0);
  }

  std::string record() const { return element_->name.substr(0, 40) + ' ' + std::to_string(number_); }
  std::size_t line() const { return ascii() ? at_ : 0; }

 private:
  bool ascii() const { return format_ == ply_header::encoding::ascii; }
  std::size_t left() const { return rest_.size() + line_.size(); }
  static bool blank(std::string_view text, const char* separators = " \t\r\v\f") {
    return text.find_first_not_of(separators) == text.npos;
  }

  double spelt(ply_type type) {
    constexpr double least[] = {-0x1p7, 0, -0x1p15, 0, -0x1p31, 0};
    constexpr double most[] = {0x1p7 - 1, 0x1p8 - 1, 0x1p15 - 1, 0x1p16 - 1, 0x1p31 - 1, 0x1p32 - 1};
    constexpr const char* names[] = {"char", "uchar", "short", "ushort", "int", "uint"};
    const std::string_view word = take_word(line_);
    if (word.empty()) refuse(file_, record() + " has fewer values than the header says", at_);
    if (is_whole(type)) {
      const auto value = number<std::int64_t>(word);
      if (!value || double(*value) < least[int(type)] || double(*value) > most[int(type)])
        refuse(file_, quoted(word) + " is no " + names[int(type)] + ", as the header says", at_);
      return double(*value);
    }
    const auto value = number<double>(word);
    if (!value || (type == ply_type::float32 && std::isfinite(*value) && !std::isfinite(float(*value))))
      refuse(file_, quoted(word) + " is not a number" + (value ? " that a float holds" : ""), at_);
    return *value;
  }

  double packed(ply_type type) {
    const std::size_t size = ply_size(type);
    if (rest_.size() < size) refuse(file_, "is cut short in " + record());
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t place = format_ == ply_header::encoding::big_endian ? size - 1 - k : k;
      bits |= std::uint64_t(static_cast<unsigned char>(rest_[k])) << 8 * place;
    }
    rest_.remove_prefix(size);

    switch (type) {
      case ply_type::int8:
        return double(std::int8_t(bits));
      case ply_type::uint8:
        return double(std::uint8_t(bits));
      case ply_type::int16:
        return double(std::int16_t(bits));
      case ply_type::uint16:
        return double(std::uint16_t(bits));
      case ply_type::int32:
        return double(std::int32_t(bits));
      case ply_type::uint32:
        return double(std::uint32_t(bits));
      case ply_type::float32:
        return double(std::bit_cast<float>(std::uint32_t(bits)));
      default:
        return std::bit_cast<double>(bits);
    }
  }

  std::string_view rest_, line_;
  const std::string& file_;
  ply_header::encoding format_;
  std::size_t at_;
  const ply_element* element_ = nullptr;
  std::uint64_t number_ = 0;
};

/// Goes through all values of a PLY file in their order. It calls `vertex(values, position)` for each record of the
/// element vertex, and `list(element, property, values, listed)` for each list; `values` says where that is. Refuses
/// what does not fit the header, including data after the last element.
template <class Vertex, class List>
void read_ply_values(std::string_view rest, const ply_header& header, const std::string& file, Vertex vertex,
                     List list) {
  ply_values values(rest, header, file);
  std::vector<double> listed;
  for (const auto& element : header.elements) {
    if (element.properties.empty()) continue;
    values.expect(element);
    const bool is_vertex = element.name == "vertex";
    std::vector<int> axes;  // by property; -1 for none
    for (const auto& p : element.properties)
      axes.push_back(is_vertex && !p.count && (p.name == "x" || p.name == "y" || p.name == "z") ? p.name[0] - 'x' : -1);
    if (is_vertex && std::ranges::count_if(axes, [](int a) { return a >= 0; }) != 3)
      refuse(file, "PLY vertices need the properties x, y and z, once each");

    for (std::uint64_t i = 0; i < element.count; ++i) {
      values.begin(element, i);
      double position[3] = {};
      for (std::size_t k = 0; k < axes.size(); ++k) {
        const auto& p = element.properties[k];
        if (!p.count) {
          const double value = values.next(p.type);
          if (axes[k] >= 0) position[axes[k]] = value;
          continue;
        }
        listed.clear();
        for (std::uint64_t left = values.list(p); left > 0; --left) listed.push_back(values.next(p.type));
        list(element, p, values, listed);
      }
      values.end();
      if (is_vertex) vertex(values, position);
    }
  }
  values.finish();
}

}  // namespace clearance::io
