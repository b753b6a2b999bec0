// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What all readers of files share: errors in sentences, limits on size, and a whole file as bytes.

#include <clearance/io/sentence.hpp>

#include <sys/stat.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace clearance::io {

/// Stops reading a file, with one sentence of at most 380 bytes. It starts with the file's name and the line, counted
/// from 1 (0: no line). Long names lose their middle.
[[noreturn]] void refuse(const std::string& file, const std::string& why, std::size_t line = 0);

/// What `read()` returns. If it needs more memory than there is, the error is a sentence that names the file.
template <class Read>
auto within_memory(const std::string& file, Read read) {
  try {
    return read();
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  }
  refuse(file, "there is not enough memory to read it");
}

/// How large a file may become. A sentence that refuses one names the limit.
struct read_limits {
  /// Bytes of memory for the points or pixels of a compressed file. A few megabytes can hold gigabytes.
  std::uint64_t unfolded = std::uint64_t(1) << 30;
  /// Bytes that come from a pipe, which may never end.
  std::uint64_t piped = std::uint64_t(1) << 32;
};

/// "1024 MiB", for sentences.
inline std::string mebibytes(std::uint64_t bytes) { return std::to_string(bytes >> 20) + " MiB"; }

/// Identifies a file, whatever its name.
struct file_identity {
  ::dev_t device = 0;
  ::ino_t number = 0;
  friend bool operator==(const file_identity&, const file_identity&) = default;
};

/// While one exists, it records the files that its thread reads, so that none of them is overwritten.
class files_read {
 public:
  files_read() : above_(innermost()) { innermost() = this; }
  ~files_read() { innermost() = above_; }
  files_read(const files_read&) = delete;
  files_read& operator=(const files_read&) = delete;

  bool has(const file_identity& file) const { return std::ranges::find(seen_, file) != seen_.end(); }

  static void note(const file_identity& file) {
    for (files_read* each = innermost(); each; each = each->above_) each->seen_.push_back(file);
  }

 private:
  static files_read*& innermost() {
    thread_local files_read* log = nullptr;
    return log;
  }
  files_read* above_;
  std::vector<file_identity> seen_;
};

/// The whole file as bytes, or what a pipe gives until it ends. An error names a file that is missing, unreadable,
/// empty (0 bytes), a folder or a device.
std::string read_bytes(const std::string& file, const read_limits& limits = {});

}  // namespace clearance::io
