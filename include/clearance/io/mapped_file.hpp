// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/error.hpp>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <span>

namespace clearance::io {

/// A file as memory, read on access. Call `bring` before you access it: it throws a sentence where the access would
/// otherwise end the process by a signal. (A file that shrinks between the two still does.)
class mapped_file {
 public:
  /// Throws std::runtime_error if there is no such file, or it is empty, a folder or a device, or cannot be mapped.
  explicit mapped_file(const std::string& file) : file_(file) {
    errno = ENOENT;
    descriptor_ = file.find('\0') != file.npos ? -1 : ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor_ < 0)
      refuse(file, errno == ENOENT || errno == ENOTDIR
                       ? "there is no such file"
                       : std::string("cannot be opened for reading: ") + std::strerror(errno));
    try {
      struct ::stat status{};
      if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode))
        refuse(file, "is no regular file, which alone can be mapped");
      if (status.st_size == 0) refuse(file, "is empty (0 bytes)");
      files_read::note({status.st_dev, status.st_ino});
      size_ = std::size_t(status.st_size);
      void* const memory = ::mmap(nullptr, size_, PROT_READ, MAP_SHARED, descriptor_, 0);
      if (memory == MAP_FAILED) refuse(file, std::string("cannot be mapped: ") + std::strerror(errno));
      data_ = static_cast<const std::byte*>(memory);
    } catch (...) {
      ::close(descriptor_);
      throw;
    }
  }
  mapped_file(const mapped_file&) = delete;
  mapped_file& operator=(const mapped_file&) = delete;
  ~mapped_file() {
    ::munmap(const_cast<std::byte*>(data_), size_);
    ::close(descriptor_);
  }

  const std::string& name() const { return file_; }
  std::span<const std::byte> bytes() const { return {data_, size_}; }

  /// Reads some of its bytes into memory, if they are not there. Throws std::runtime_error if the file's size has
  /// changed since it was opened, or if it cannot be read.
  void bring(std::span<const std::byte> some) const {
    struct ::stat status{};
    if (::fstat(descriptor_, &status) != 0) refuse(file_, std::string("cannot be read: ") + std::strerror(errno));
    if (std::size_t(status.st_size) != size_)
      refuse(file_, "had " + std::to_string(size_) + " bytes when it was opened, and has " +
                        std::to_string(status.st_size) + " now");
    if (some.empty()) return;
    const auto page = std::uintptr_t(::sysconf(_SC_PAGESIZE)), first = reinterpret_cast<std::uintptr_t>(some.data());
    const std::uintptr_t begin = first / page * page, length = first + some.size() - begin;
    ::madvise(reinterpret_cast<void*>(begin), length,
              MADV_WILLNEED);          // all that is missing, at once
    constexpr int populate_read = 22;  // MADV_POPULATE_READ of Linux 5.14; before it: EINVAL, and access reads
    if (::madvise(reinterpret_cast<void*>(begin), length, populate_read) != 0 && errno != EINVAL)
      refuse(file_, "cannot be read at byte " + std::to_string(some.data() - data_) + ": " +
                        (errno == EFAULT ? "Input/output error" : std::strerror(errno)));
  }

 private:
  std::string file_;
  int descriptor_ = -1;
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace clearance::io
