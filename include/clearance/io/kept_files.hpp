// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cache: files in a folder that any number of programs may share.

#include <clearance/io/digest.hpp>

#include <exception>
#include <filesystem>
#include <utility>

namespace clearance::io {

/// A folder of files that are named by digests. Any number of programs may use it at once: a file gets its name only
/// when it is complete (write_bytes). A file that cannot be read counts as absent. You may empty the folder at any
/// time.
class kept_files {
 public:
  kept_files() = default;  ///< Keeps and finds nothing.
  kept_files(std::filesystem::path folder, std::string ending)
      : folder_(std::move(folder)), ending_(std::move(ending)) {}

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path file(const digest& key) const { return folder_ / (key.hex() + ending_); }

  /// What `read(file)` returns, an optional or another type that may be empty; empty if it throws.
  template <class Read>
  auto find(const digest& key, Read read) const -> decltype(read(std::string())) {
    std::error_code none;
    if (folder_.empty() || !std::filesystem::is_regular_file(file(key), none)) return {};
    try {
      return read(file(key).string());
    } catch (const std::exception&) {
      return {};
    }
  }

  /// Calls `write(file)`. Returns whether it is kept; a failure to write is no error.
  template <class Write>
  bool keep(const digest& key, Write write) const {
    if (folder_.empty()) return false;
    std::error_code failed;
    std::filesystem::create_directories(folder_, failed);
    try {
      write(file(key).string());
      return true;
    } catch (const std::exception&) {
      return false;
    }
  }

 private:
  std::filesystem::path folder_;
  std::string ending_;
};

}  // namespace clearance::io
