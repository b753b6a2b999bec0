// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points with numbers of one's own beside them, as any viewer of PLY files shows them.

#include <clearance/io/bytes.hpp>
#include <clearance/io/write_file.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <span>
#include <variant>
#include <vector>

namespace clearance::io {

/// One number a point, by the name that a viewer shows. "red", "green" and "blue" of 8 bits are its colour.
struct ply_column {
  std::string name;
  std::variant<std::vector<float>, std::vector<std::uint8_t>, std::vector<std::int32_t>, std::vector<std::uint32_t>> values;
};

/// A PLY file, binary and little-endian: positions in double, then the columns in their order. Throws std::invalid_argument if a
/// column has not one value a point, or a name that is no word.
inline std::string ply_bytes(std::span<const Eigen::Vector3d> points, std::span<const ply_column> columns, const std::string& comment = {}) {
  constexpr const char* kinds[] = {"float", "uchar", "int", "uint"};
  byte_writer out;
  out.put(std::string_view("ply\nformat binary_little_endian 1.0\n"));
  if (!comment.empty()) out.put(std::string_view("comment " + printable(comment) + '\n'));
  out.put(std::string_view("element vertex " + std::to_string(points.size()) + "\nproperty double x\nproperty double y\nproperty double z\n"));
  std::size_t record = 3 * sizeof(double);
  for (const ply_column& column : columns) {
    if (column.name.empty() || std::ranges::any_of(column.name, [](char c) { return c <= ' ' || c > '~'; }))
      throw std::invalid_argument("clearance: " + io::quoted(column.name) + " is no name of a PLY column");
    std::visit(
        [&](const auto& values) {
          if (values.size() != points.size())
            throw std::invalid_argument("clearance: the PLY column " + io::quoted(column.name) + " has " + std::to_string(values.size()) + " values for " +
                                        std::to_string(points.size()) + " points");
          record += sizeof values[0];
        },
        column.values);
    out.put(std::string_view(std::string("property ") + kinds[column.values.index()] + ' ' + column.name + '\n'));
  }
  out.put(std::string_view("end_header\n"));
  out.reserve(out.bytes().size() + record * points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int k = 0; k < 3; ++k) out.put(points[i][k]);
    for (const ply_column& column : columns)
      std::visit(
          [&](const auto& values) {
            if constexpr (std::is_same_v<decltype(values[i]), const std::int32_t&>)
              out.put(std::uint32_t(values[i]));
            else
              out.put(values[i]);
          },
          column.values);
  }
  return out.bytes();
}

/// Writes it, whole or not at all. Throws std::runtime_error naming the file.
inline void save_ply(const std::string& file, std::span<const Eigen::Vector3d> points, std::span<const ply_column> columns, const std::string& comment = {}) {
  write_bytes(file, ply_bytes(points, columns, comment));
}

}  // namespace clearance::io
