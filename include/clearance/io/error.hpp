// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>

namespace clearance::io {

/// Ends the reading of a file with one sentence that starts with its name (and line, counted from 1; 0 for none).
[[noreturn]] inline void refuse(const std::string& file, const std::string& why, std::size_t line = 0) {
  throw std::runtime_error(file + (line ? ":" + std::to_string(line) : "") + ": " + why);
}

/// The whole file as bytes. A missing, unreadable or empty one (0 bytes) is an error that names it.
inline std::string read_bytes(const std::string& file) {
  std::error_code failed;
  const auto status = std::filesystem::status(file, failed);
  if (!std::filesystem::exists(status)) refuse(file, "there is no such file");
  if (std::filesystem::is_directory(status)) refuse(file, "is a folder, not a file");
  std::ifstream in(file, std::ios::binary);
  if (!in) refuse(file, "cannot be opened for reading");
  std::string bytes;
  // In pieces, not by the size that the file system reports: a pipe or /dev/stdin has none.
  for (char piece[1 << 16]; in.read(piece, sizeof piece), in.gcount() > 0;) bytes.append(piece, std::size_t(in.gcount()));
  if (in.bad()) refuse(file, "cannot be read");
  if (bytes.empty()) refuse(file, "is empty (0 bytes)");
  return bytes;
}

}  // namespace clearance::io
