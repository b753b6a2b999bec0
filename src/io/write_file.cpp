// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/write_file.hpp>

#include "io/file_beside.hpp"

namespace clearance::io {

std::optional<struct ::stat> check_target(const std::string& file) {
  struct ::stat present{};
  if (file.empty() || file.find('\0') != file.npos) refuse(file, "is no name of a file");
  if (::lstat(file.c_str(), &present) != 0) {
    if (errno != ENOENT) refuse(file, std::string("cannot be written: ") + std::strerror(errno));
    return std::nullopt;
  }
  if (S_ISDIR(present.st_mode)) refuse(file, "is a folder, and cannot be written");
  if (S_ISLNK(present.st_mode)) refuse(file, "is a symbolic link, which is not written through: name the file itself");
  if (!S_ISREG(present.st_mode)) refuse(file, "is no regular file, and is not written to");
  return present;
}

namespace {

template <class Next>
void replace(const std::string& file, Next next) {
  const auto present = check_target(file);
  file_beside made(file, present ? 0600 : 0666);
  if (present) made.allow(present->st_mode & 0777);
  for (auto piece = next(); !piece.empty(); piece = next()) made.write(piece);
  made.put_in_place();
}

}  // namespace

void write_pieces(const std::string& file, const std::function<std::string()>& next) { replace(file, next); }

void write_bytes(const std::string& file, std::string_view bytes) {
  replace(file, [&] { return std::exchange(bytes, {}); });
}

void check_output(const std::string& file, const files_read& inputs) {
  const auto present = check_target(file);
  if (present && inputs.has({present->st_dev, present->st_ino}))
    refuse(file, "is a file that this reads, and is not written over");
}

}  // namespace clearance::io
