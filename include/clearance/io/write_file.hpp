// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The only way in which this library writes files: beside, then in place, so a full disk or a crash does no damage.

#include <clearance/io/error.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <random>
#include <utility>

namespace clearance::io {

/// Refuses to replace a folder, device, pipe or symbolic link (should the file behind it be replaced?). Returns the
/// status of the present file, if there is one.
inline std::optional<struct ::stat> check_target(const std::string& file) {
  struct ::stat there{};
  if (file.empty() || file.find('\0') != file.npos) refuse(file, "is no name of a file");
  if (::lstat(file.c_str(), &there) != 0) {
    if (errno != ENOENT) refuse(file, std::string("cannot be written: ") + std::strerror(errno));
    return std::nullopt;
  }
  if (S_ISDIR(there.st_mode)) refuse(file, "is a folder, and cannot be written");
  if (S_ISLNK(there.st_mode)) refuse(file, "is a symbolic link, which is not written through: name the file itself");
  if (!S_ISREG(there.st_mode)) refuse(file, "is no regular file, and is not written to");
  return there;
}

namespace detail {

/// A new file in the folder of `file`. It has no name until it is put in place, so nothing is left if the program ends
/// early. Where the system has no such files, it gets an unpredictable name, and loses it at the end.
class file_beside {
 public:
  file_beside(const std::string& file, ::mode_t mode) : file_beside(file) {  // so what throws here is cleaned up
    at_ = ::open(folder_.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, mode);
    if (at_ >= 0 && ::access(itself().c_str(), F_OK) != 0) ::close(std::exchange(at_, -1));  // it could get no name
    if (at_ < 0)
      under_new_name([&](const char* name) {
        at_ = ::open(name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
        return at_ >= 0;
      });
  }
  file_beside(const file_beside&) = delete;
  file_beside& operator=(const file_beside&) = delete;
  ~file_beside() {
    if (at_ >= 0) ::close(at_);
    if (!name_.empty()) ::unlink(name_.c_str());
  }

  void allow(::mode_t mode) {
    if (::fchmod(at_, mode) != 0) fail("its permissions cannot be kept");
  }
  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ::ssize_t done = ::write(at_, bytes.data(), std::min(bytes.size(), std::size_t(1) << 30));
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0) fail("");
      bytes.remove_prefix(std::size_t(done));
    }
  }
  void put_in_place() {
    if (::fsync(at_) != 0) fail("");
    if (name_.empty() && !link_to(file_.c_str())) {  // only a rename replaces an older one
      if (errno != EEXIST) fail("the new file cannot take its place");
      under_new_name([&](const char* name) { return link_to(name); });
    }
    if (::close(std::exchange(at_, -1)) != 0) fail("");
    if (!name_.empty() && ::rename(name_.c_str(), file_.c_str()) != 0) fail("the new file cannot take its place");
    name_.clear();
    if (const int folder = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); folder >= 0) {
      ::fsync(folder);  // so the name survives a crash now; not every file system can
      ::close(folder);
    }
  }

 private:
  explicit file_beside(const std::string& file) : file_(file) {
    const std::size_t slash = file.rfind('/');
    folder_ = slash == file.npos ? "." : file.substr(0, slash + 1);
    before_ = (slash == file.npos ? "" : folder_) + ".clearance-";
  }

  std::string itself() const { return "/proc/self/fd/" + std::to_string(at_); }
  bool link_to(const char* name) const {
    return ::linkat(AT_FDCWD, itself().c_str(), AT_FDCWD, name, AT_SYMLINK_FOLLOW) == 0;
  }

  /// Gives it a name that is not taken, kept in `name_`.
  template <class Make>
  void under_new_name(Make make) {
    std::random_device random;
    for (int tries = 0;; ++tries) {
      std::string name = before_;
      for (int k = 0; k < 4; ++k) name += std::to_string(random());
      if (make(name.c_str())) {
        name_ = std::move(name);
        return;
      }
      if (errno != EEXIST || tries > 9) fail("a new file beside it cannot be made");
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    const std::string why = std::strerror(errno);
    refuse(file_, "cannot be written" + (what.empty() ? ": " + why : ": " + what + " (" + why + ")"));
  }

  const std::string& file_;
  std::string folder_, before_, name_;  // its temporary name, while it has one
  int at_ = -1;
};

}  // namespace detail

/// The same as write_bytes, for what `next()` returns, until that is empty.
template <class Next>
void write_pieces(const std::string& file, Next next) {
  const auto there = check_target(file);
  detail::file_beside made(file, there ? 0600 : 0666);
  if (there) made.allow(there->st_mode & 0777);
  for (auto piece = next(); !piece.empty(); piece = next()) made.write(piece);
  made.put_in_place();
}

/// Replaces the file's content completely or not at all. The bytes go to a new file beside it, reach the disk, and then
/// take its name and permissions. Throws std::runtime_error naming the file, which is then unchanged.
inline void write_bytes(const std::string& file, std::string_view bytes) {
  write_pieces(file, [&] { return std::exchange(bytes, {}); });
}

/// The same as check_target; also refuses a file that `inputs` has recorded.
inline void check_output(const std::string& file, const files_read& inputs) {
  const auto there = check_target(file);
  if (there && inputs.has({there->st_dev, there->st_ino}))
    refuse(file, "is a file that this reads, and is not written over");
}

}  // namespace clearance::io
