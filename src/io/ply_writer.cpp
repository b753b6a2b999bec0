// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/ply_writer.hpp>

#include <clearance/io/bytes.hpp>
#include <clearance/io/write_file.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace clearance::io {

namespace {

/// The file's header for `count` points with these columns. Throws std::invalid_argument if a column's name is not a
/// word.
std::string ply_header_text(std::size_t count, std::span<const ply_column> columns, const std::string& comment = {}) {
  constexpr const char* kinds[] = {"float", "uchar", "int", "uint"};
  std::string out = "ply\nformat binary_little_endian 1.0\n";
  if (!comment.empty()) out += "comment " + printable(comment) + '\n';
  out += "element vertex " + std::to_string(count) + "\nproperty double x\nproperty double y\nproperty double z\n";
  for (const ply_column& column : columns) {
    if (column.name.empty() || std::ranges::any_of(column.name, [](char c) { return c <= ' ' || c > '~'; }))
      throw std::invalid_argument("clearance: " + io::quoted(column.name) + " is no name of a PLY column");
    out += std::string("property ") + kinds[column.values.index()] + ' ' + column.name + '\n';
  }
  return out + "end_header\n";
}

/// The records of the points: positions in double, then the columns in their order. Throws std::invalid_argument unless
/// every column has one value per point.
std::string ply_records(std::span<const Eigen::Vector3d> points, std::span<const ply_column> columns) {
  byte_writer out;
  std::size_t record = 3 * sizeof(double);
  for (const ply_column& column : columns)
    std::visit(
        [&](const auto& values) {
          if (values.size() != points.size())
            throw std::invalid_argument("clearance: the PLY column " + io::quoted(column.name) + " has " +
                                        std::to_string(values.size()) + " values for " + std::to_string(points.size()) +
                                        " points");
          record += sizeof values[0];
        },
        column.values);

  out.reserve(record * points.size());
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

}  // namespace

std::string ply_bytes(std::span<const Eigen::Vector3d> points, std::span<const ply_column> columns,
                      const std::string& comment) {
  return ply_header_text(points.size(), columns, comment) + ply_records(points, columns);
}

void save_ply(const std::string& file, std::span<const Eigen::Vector3d> points, std::span<const ply_column> columns,
              const std::string& comment) {
  write_bytes(file, ply_bytes(points, columns, comment));
}

void save_ply_pieces(const std::string& file, std::size_t count, const std::function<ply_piece()>& next,
                     const std::string& comment) {
  std::size_t done = 0;
  bool begun = false;
  write_pieces(file, [&]() -> std::string {
    if (begun && done == count) return {};
    const ply_piece piece = next();
    if (piece.points.size() > count - done || (piece.points.empty() && count != 0))
      throw std::invalid_argument("clearance: a piece of " + std::to_string(piece.points.size()) + " points where " +
                                  std::to_string(count - done) + " are missing");
    done += piece.points.size();
    const std::string before =
        std::exchange(begun, true) ? std::string() : ply_header_text(count, piece.columns, comment);
    return before + ply_records(piece.points, piece.columns);
  });
}

}  // namespace clearance::io
