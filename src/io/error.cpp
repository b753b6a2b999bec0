// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/error.hpp>

#include <clearance/io/sentence.hpp>

#include <sys/stat.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace clearance::io {

void refuse(const std::string& file, const std::string& why, std::size_t line) {
  throw std::runtime_error(sentence_about(sentence(file, 200) + (line ? ":" + std::to_string(line) : ""), why));
}

std::string read_bytes(const std::string& file, const read_limits& limits) {
  struct ::stat status{};
  // A NUL would end the name for the system, but not for us.
  if (file.find('\0') != file.npos || ::stat(file.c_str(), &status) != 0) refuse(file, "there is no such file");
  if (S_ISDIR(status.st_mode)) refuse(file, "is a folder, not a file");
  if (S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode)) refuse(file, "is a device, not a file");
  const bool regular = S_ISREG(status.st_mode);
  std::ifstream in(file, std::ios::binary);
  if (!in) refuse(file, "cannot be opened for reading");
  if (regular) files_read::note({status.st_dev, status.st_ino});
  std::string bytes = within_memory(file, [&] {
    std::string all;
    if (regular) all.reserve(std::size_t(status.st_size));
    // In pieces: a pipe has no size, and a file may grow meanwhile.
    for (char piece[1 << 16]; in.read(piece, sizeof piece), in.gcount() > 0;) {
      all.append(piece, std::size_t(in.gcount()));
      if (!regular && all.size() > limits.piped)
        refuse(file, "gives more than " + mebibytes(limits.piped) + ", the limit for what is no regular file");
    }
    return all;
  });
  if (in.bad()) refuse(file, "cannot be read");
  if (bytes.empty()) refuse(file, "is empty (0 bytes)");
  return bytes;
}

}  // namespace clearance::io
