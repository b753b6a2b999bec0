// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/mapped_cloud.hpp>

#include "io/pcd.hpp"

#include <clearance/io/error.hpp>
#include <clearance/points/loaded.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/points/strided_points.hpp>

#include <sys/mman.h>

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <memory>
#include <span>

namespace clearance::io {

mapped_file::mapped_file(const std::string& file) : file_(file) {
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

mapped_file::~mapped_file() {
  ::munmap(const_cast<std::byte*>(data_), size_);
  ::close(descriptor_);
}

void mapped_file::bring(std::span<const std::byte> some) const {
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

mapped_cloud<point_span> map_points(const std::string& file, std::size_t header) {
  const auto mapped = std::make_shared<const mapped_file>(file);
  const std::size_t bytes = mapped->bytes().size();
  if (bytes < header || (bytes - header) % sizeof(vec3) != 0)
    refuse(file, "ends in the middle of a record of 12 bytes: it has " + std::to_string(bytes) + " bytes, " +
                     std::to_string(header) + " of them before the first");
  if (header % alignof(vec3) != 0)
    refuse(file,
           "has a header of " + std::to_string(header) + " bytes, which is no multiple of 4 (map_records takes it)");
  return {mapped,
          point_span(reinterpret_cast<const vec3*>(mapped->bytes().data() + header), (bytes - header) / sizeof(vec3))};
}

detail::pcd_layout detail::pcd_layout_of(const std::string& file, std::size_t scalar) {
  // Opens the file once: by the time that its header is read, the name may belong to another file.
  const auto mapped = std::make_shared<const mapped_file>(file);
  const std::span<const std::byte> bytes = mapped->bytes();
  const std::span<const std::byte> start =
      bytes.first(std::min<std::size_t>(bytes.size(), 1 << 20));  // a header must be within this
  mapped->bring(start);
  std::string_view rest(reinterpret_cast<const char*>(start.data()), start.size());
  const pcd_header header = take_pcd_header(rest, file);
  const std::size_t before = start.size() - rest.size();
  if (rest.empty() && start.size() < bytes.size()) refuse(file, "has a PCD header of 1 MiB or more");
  rest = std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()).substr(before);

  if (header.data != pcd_header::encoding::binary)
    refuse(file, "is a PCD file whose DATA is not binary, which alone can be mapped (load_pcd reads it)");
  if (header.points > rest.size() / header.record_bytes)
    refuse(file, "POINTS says " + std::to_string(header.points) + " records of " + std::to_string(header.record_bytes) +
                     " bytes, but the file ends " + std::to_string(rest.size()) + " bytes after the header");
  mapped->bring(bytes.last(std::min<std::size_t>(rest.size() - header.points * header.record_bytes, 4096)));
  check_pcd_end(rest.substr(header.points * header.record_bytes), header, file);

  detail::pcd_layout layout{.file = mapped, .before = before, .viewpoint = header.viewpoint};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const pcd_field& field = header.fields[header.xyz[axis]];
    if (field.type != 'F' || field.size != scalar)
      refuse(file, "field " + field.name + " is of TYPE " + field.type + " and SIZE " + std::to_string(field.size) +
                       ", not F and " + std::to_string(scalar));
    layout.offset[axis] = std::uint32_t(field.offset);
  }
  if (header.record_bytes > 0xffffffff) refuse(file, "records of " + std::to_string(header.record_bytes) + " bytes");
  layout.step = std::uint32_t(header.record_bytes);
  layout.count = header.points;
  if (header.points == 0) refuse(file, "POINTS is 0: there is nothing to map");
  return layout;
}

}  // namespace clearance::io
