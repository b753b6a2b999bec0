// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/pcd_header.hpp>

#include <liblzf/lzf.h>

#include <bit>
#include <cstring>

namespace clearance::io {

static_assert(std::endian::native == std::endian::little, "PCD files are little-endian; so must the reader be");

/// One element of a record as a double, whatever its type.
inline double pcd_value(const char* bytes, const pcd_field& field) {
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
inline std::vector<Eigen::Vector3d> pcd_records(const char* data, const pcd_header& header, bool by_field) {
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
inline double pcd_spelt(std::string_view word, const pcd_field& field, const std::string& file, std::size_t line) {
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

inline std::vector<Eigen::Vector3d> pcd_ascii(std::string_view rest, const pcd_header& header,
                                              const std::string& file) {
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

/// Refuses data beyond POINTS, except the zeros with which some writers fill a page, and a line end before or after
/// them.
inline void check_pcd_end(std::string_view rest, const pcd_header& header, const std::string& file) {
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

inline std::vector<Eigen::Vector3d> pcd_compressed(std::string_view rest, const pcd_header& header,
                                                   const std::string& file, const read_limits& limits) {
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

/// Reads a PCD file from memory; `file` is its name in the cloud and in errors.
inline cloud read_pcd(std::string_view bytes, const std::string& file, const read_limits& limits = {}) {
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

/// Reads a PCD file: ascii, binary or binary_compressed; its fields in any order and of any type; others are skipped.
/// Throws std::runtime_error naming file and line, also if POINTS does not match the data.
inline cloud load_pcd(const std::string& file, const read_limits& limits = {}) {
  return read_pcd(read_bytes(file, limits), file, limits);
}

}  // namespace clearance::io
