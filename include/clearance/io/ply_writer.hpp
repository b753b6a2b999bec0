// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points with numbers of your own, in a form that every viewer of PLY files shows.

#include <clearance/io/same_eigen.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace clearance::io {

/// One number per point, under the name that a viewer shows. 8-bit "red", "green" and "blue" are its colour.
struct ply_column {
  std::string name;
  std::variant<std::vector<float>, std::vector<std::uint8_t>, std::vector<std::int32_t>, std::vector<std::uint32_t>>
      values;
};

/// Points with their columns; a file is written piece by piece.
struct ply_piece {
  std::vector<Eigen::Vector3d> points;
  std::vector<ply_column> columns;
};

/// A PLY file, binary and little-endian. Throws std::invalid_argument for a column whose name is not a word, or that
/// has not one value per point.
std::string ply_bytes(std::span<const Eigen::Vector3d> points, std::span<const ply_column> columns,
                      const std::string& comment = {});

/// Writes ply_bytes to a file, completely or not at all. Throws as that, and std::runtime_error naming the file.
void save_ply(const std::string& file, std::span<const Eigen::Vector3d> points, std::span<const ply_column> columns,
              const std::string& comment = {});

/// As save_ply, for `count` points that need not be in memory at once. `next()` returns a ply_piece; it is called at
/// least once, and until no point is missing. All pieces have the same column names and kinds. Throws
/// std::invalid_argument if a piece is empty while points are missing, or has too many.
void save_ply_pieces(const std::string& file, std::size_t count, const std::function<ply_piece()>& next,
                     const std::string& comment = {});

}  // namespace clearance::io
