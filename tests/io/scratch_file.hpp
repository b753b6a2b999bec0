// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

/// A file that is deleted with the object.
struct scratch_file {
  std::string path;

  explicit scratch_file(const std::string& end, const std::string& bytes = {}) {
    static int count = 0;
    path = (std::filesystem::temp_directory_path() /
            ("clearance_" + std::to_string(::getpid()) + "_" + std::to_string(++count) + end))
               .string();
    put(bytes);
  }
  scratch_file(const scratch_file&) = delete;
  scratch_file& operator=(const scratch_file&) = delete;
  ~scratch_file() { std::filesystem::remove(path); }

  void put(const std::string& bytes) const { std::ofstream(path, std::ios::binary) << bytes; }
};

/// The bytes of numbers, one after another, for a binary file.
template <class... T>
std::string raw_bytes(T... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return bytes;
}

/// The sentence with which `read` refuses; empty if it does not.
template <class Read>
std::string refusal(Read read) {
  try {
    read();
    return {};
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}
