// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A new file beside another, whose place it takes at once when it is complete.

#include <clearance/io/error.hpp>

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <optional>
#include <random>
#include <utility>

namespace clearance::io {

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

}  // namespace clearance::io
