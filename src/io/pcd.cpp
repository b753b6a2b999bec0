// SPDX-License-Identifier: BSD-3-Clause
#include "io/pcd.hpp"

#include <clearance/io/cloud.hpp>
#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/text_file.hpp>

#include <liblzf/lzf.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clearance::io {

namespace {

// The header of a PCD file (versions .5 to .7), read strictly: anything not understood is an error that names the line.

/// Fills in offsets and finds x, y and z. Fields and counts are bounded, so nothing overflows.
void lay_out(pcd_header& header, const std::string& file) {
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

/// Reads the entries of a PCD header, one after another.
class pcd_entries {
 public:
  explicit pcd_entries(const std::string& file) : file_(file) {}

  /// Takes one line. Returns true if it was DATA, which ends the header.
  bool read_line(std::string_view line) {
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
    for_fields("COUNT", [&](pcd_field& field, std::string_view word) { field.count = whole(word, 0, most, "COUNT"); });
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

}  // namespace

pcd_header take_pcd_header(std::string_view& rest, const std::string& file) {
  pcd_entries entries(file);
  const std::string_view all = rest = without_mark(rest);
  while (!rest.empty()) {
    if (!entries.read_line(take_line(rest))) continue;
    entries.finish();
    const std::size_t behind = rest.size();
    rest = data_after(all, rest);
    entries.made.line_end_left = rest.size() != behind;
    return std::move(entries.made);
  }
  refuse(file, "the PCD header has no DATA entry (is the file cut short, or no PCD?)");
}

namespace {

static_assert(std::endian::native == std::endian::little, "PCD files are little-endian; so must the reader be");

/// One element of a record as a double, whatever its type.
double pcd_value(const char* bytes, const pcd_field& field) {
  const auto as = [&]<class T>(T value) {
    std::memcpy(&value, bytes, sizeof value);
    return double(value);
  };

  switch (field.size | (field.type == 'F' ? 16u : field.type == 'I' ? 32u : 64u)) {
    case 16 | 4:
      return as(float{});
    case 16 | 8:
      return as(double{});
    case 32 | 1:
      return as(std::int8_t{});
    case 32 | 2:
      return as(std::int16_t{});
    case 32 | 4:
      return as(std::int32_t{});
    case 32 | 8:
      return as(std::int64_t{});
    case 64 | 1:
      return as(std::uint8_t{});
    case 64 | 2:
      return as(std::uint16_t{});
    case 64 | 4:
      return as(std::uint32_t{});
    default:
      return as(std::uint64_t{});
  }
}

/// x, y, z of `points` records; value k of record i is at offset[k] + i * step[k]. The caller has checked the size.
std::vector<Eigen::Vector3d> pcd_records(const char* data, const pcd_header& header, bool by_field) {
  std::vector<Eigen::Vector3d> points(header.points);
  for (int axis = 0; axis < 3; ++axis) {
    const auto& field = header.fields[header.xyz[std::size_t(axis)]];
    const char* at = data + field.offset * (by_field ? header.points : 1);
    for (auto& p : points) {
      p[axis] = pcd_value(at, field);
      at += by_field ? field.size : header.record_bytes;
    }
  }
  return points;
}

/// The value that a word of a field spells. Refuses a word that does not fit the field's type.
double pcd_spelt(std::string_view word, const pcd_field& field, const std::string& file, std::size_t line) {
  const auto value = number<double>(word);
  if (!value) refuse(file, quoted(word) + " is not a number", line);
  const double most =
      std::exp2(8.0 * double(field.size) - (field.type == 'I' ? 1 : 0));  // first value beyond an integer type
  const bool fits = field.type == 'F'
                        ? field.size > 4 || !std::isfinite(*value) || std::isfinite(float(*value))
                        : *value == std::floor(*value) && *value >= (field.type == 'I' ? -most : 0) && *value < most;
  if (!fits)
    refuse(file, quoted(word) + " is not of TYPE " + field.type + " and SIZE " + std::to_string(field.size), line);
  return *value;
}

std::vector<Eigen::Vector3d> pcd_ascii(std::string_view rest, const pcd_header& header, const std::string& file) {
  if (header.points > rest.size() / 2 + 1)  // a record needs at least a digit and a line end
    refuse(file, "POINTS says " + std::to_string(header.points) + ", more than a file of this size can hold");

  std::vector<Eigen::Vector3d> points;
  points.reserve(header.points);
  for (std::size_t at = header.lines + 1; !rest.empty(); ++at) {
    std::string_view line = take_line(rest);
    if (const auto end = line.find('\0'); end != line.npos) line = line.substr(0, end);  // padding
    const auto values = words(line);
    if (values.empty()) continue;
    if (points.size() == header.points)
      refuse(file, "POINTS says " + std::to_string(header.points) + ", but here is another record", at);
    if (values.size() != header.record_words)
      refuse(file,
             "a record needs " + std::to_string(header.record_words) + " values, here are " +
                 std::to_string(values.size()),
             at);
    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; ++axis) {
      const auto& field = header.fields[header.xyz[std::size_t(axis)]];
      p[axis] = pcd_spelt(values[field.column], field, file, at);
    }
    points.push_back(p);
  }

  if (points.size() != header.points)
    refuse(file, "POINTS says " + std::to_string(header.points) + ", but the file ends after " +
                     std::to_string(points.size()) + " records");
  return points;
}

}  // namespace

void check_pcd_end(std::string_view rest, const pcd_header& header, const std::string& file) {
  if (header.line_end_left && !rest.empty())
    refuse(file,
           "some lines of the header end with \\r and the last one with \\r\\n, so it is unclear where the data begin");
  std::string_view zeros = rest;
  for (const std::string_view end : {"\r\n", "\n"})
    if (zeros.size() == rest.size() && zeros.ends_with(end))
      zeros.remove_suffix(end.size());
    else if (zeros.size() == rest.size() && zeros.starts_with(end))
      zeros.remove_prefix(end.size());
  if (zeros.size() >= 4096 || zeros.find_first_not_of('\0') != zeros.npos)
    refuse(file, "POINTS says " + std::to_string(header.points) + ", but " + std::to_string(rest.size()) +
                     " bytes follow the last record");
}

namespace {

std::vector<Eigen::Vector3d> pcd_compressed(std::string_view rest, const pcd_header& header, const std::string& file,
                                            const read_limits& limits) {
  if (header.points == 0) return {};
  std::uint32_t packed = 0, unpacked = 0;
  if (rest.size() < 8) refuse(file, "the file ends before the sizes of the compressed block");
  std::memcpy(&packed, rest.data(), 4);
  std::memcpy(&unpacked, rest.data() + 4, 4);
  rest.remove_prefix(8);
  if (packed > rest.size())
    refuse(file, "the compressed block of " + std::to_string(packed) + " bytes is cut short after " +
                     std::to_string(rest.size()));
  if (unpacked / header.record_bytes != header.points || unpacked % header.record_bytes != 0)
    refuse(file, "the compressed block holds " + std::to_string(unpacked) + " bytes, not POINTS " +
                     std::to_string(header.points) + " records of " + std::to_string(header.record_bytes));
  if (unpacked / 88 > packed)  // three bytes of LZF stand for at most 264
    refuse(file, "the compressed block says that " + std::to_string(packed) + " bytes unpack to " +
                     std::to_string(unpacked) + ", which is impossible");
  check_pcd_end(rest.substr(packed), header, file);
  const std::uint64_t memory = unpacked + header.points * (sizeof(Eigen::Vector3d) + sizeof(vec3));
  if (memory > limits.unfolded)
    refuse(file, std::to_string(rest.size()) + " bytes unfold to " + mebibytes(memory) +
                     " of points, more than the limit of " + mebibytes(limits.unfolded) +
                     " (read_limits::unfolded), which --unfold-limit of the command raises");
  std::vector<char> data(unpacked);
  if (lzf_decompress(rest.data(), packed, data.data(), unpacked) != unpacked)
    refuse(file, "the compressed block is damaged");
  return pcd_records(data.data(), header, true);  // stored field by field
}

}  // namespace

cloud read_pcd(std::string_view bytes, const std::string& file, const read_limits& limits) {
  std::string_view rest = bytes;
  const pcd_header header = take_pcd_header(rest, file);
  std::vector<Eigen::Vector3d> points;
  switch (header.data) {
    case pcd_header::encoding::ascii:
      points = pcd_ascii(rest, header, file);
      break;
    case pcd_header::encoding::binary:
      if (header.points > rest.size() / header.record_bytes)
        refuse(file, "POINTS says " + std::to_string(header.points) + " records of " +
                         std::to_string(header.record_bytes) + " bytes, but the file ends " +
                         std::to_string(rest.size()) + " bytes after the header");
      check_pcd_end(rest.substr(header.points * header.record_bytes), header, file);
      points = pcd_records(rest.data(), header, false);
      break;
    case pcd_header::encoding::binary_compressed:
      points = pcd_compressed(rest, header, file, limits);
      break;
  }
  cloud made = make_cloud(file, points, header.width, header.height);
  made.viewpoint = header.viewpoint;
  return made;
}

cloud load_pcd(const std::string& file, const read_limits& limits) {
  return read_pcd(read_text(file, limits), file, limits);
}

}  // namespace clearance::io
