// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Clouds in files that may be larger than memory, for `chunked`.

#include <clearance/io/cloud.hpp>
#include <clearance/io/error.hpp>
#include <clearance/points/loaded.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/points/strided_points.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace clearance::io {

/// A file as memory, read on access. Call `bring` before you access it: it throws a sentence where the access would
/// otherwise end the process by a signal. (A file that shrinks between the two still does.)
class mapped_file {
 public:
  /// Throws std::runtime_error if there is no such file, or it is empty, a folder or a device, or cannot be mapped.
  explicit mapped_file(const std::string& file);
  mapped_file(const mapped_file&) = delete;
  mapped_file& operator=(const mapped_file&) = delete;
  ~mapped_file();

  const std::string& name() const { return file_; }
  std::span<const std::byte> bytes() const { return {data_, size_}; }

  /// Reads some of its bytes into memory, if they are not there. Throws std::runtime_error if the file's size has
  /// changed since it was opened, or if it cannot be read.
  void bring(std::span<const std::byte> some) const;

 private:
  std::string file_;
  int descriptor_ = -1;
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

/// A `loaded_cloud`: its source points into a mapped file, which it keeps open.
template <point_source S>
struct mapped_cloud {
  std::shared_ptr<const mapped_file> file;
  S source;
  std::optional<io::viewpoint> viewpoint = {};  ///< Where the sensor was, if a PCD file says so.

  std::size_t size() const { return source.size(); }
  std::size_t bytes_for(std::size_t) const { return 0; }
  const S& whole() const { return source; }
  auto load(std::size_t begin, std::size_t end, std::byte*) const {
    const auto some = slice(source, begin, end);
    file->bring(some.bytes());
    return some;
  }
};

/// Records of x, y, z in floats (12 bytes each), starting `header` bytes into the file. Throws std::runtime_error if
/// the file ends within a record, or if `header` is no multiple of 4, so that floats are not aligned.
mapped_cloud<point_span> map_points(const std::string& file, std::size_t header = 0);

static_assert(addressed_cloud<mapped_cloud<point_span>>);

namespace detail {

template <class Scalar>
mapped_cloud<strided_points<Scalar>> records_of(const std::shared_ptr<const mapped_file>& mapped,
                                                strided_points<Scalar> layout, std::size_t header) {
  const std::string& file = mapped->name();
  const std::size_t bytes = mapped->bytes().size();
  for (const std::uint32_t offset : layout.offset)
    if (offset + sizeof(Scalar) > layout.step)
      refuse(file, "a coordinate at byte " + std::to_string(offset) + " of records of " + std::to_string(layout.step) +
                       " bytes");
  if (layout.width != 0) refuse(file, "records in padded rows cannot be mapped");
  const std::size_t held = bytes < header ? 0 : (bytes - header) / layout.step;
  if (layout.count == 0 && (bytes < header || (bytes - header) % layout.step != 0))
    refuse(file, "ends in the middle of a record of " + std::to_string(layout.step) + " bytes: it has " +
                     std::to_string(bytes) + " bytes, " + std::to_string(header) + " of them before the first");
  if (layout.count > held)
    refuse(file, "has " + std::to_string(held) + " records, not " + std::to_string(layout.count));
  if (layout.count == 0) layout.count = held;
  layout.data = mapped->bytes().data() + header;
  return {mapped, layout, {}};
}

}  // namespace detail

/// Records as `layout` describes them: step, offsets, origin, filter. If its `count` is 0, all records of the file.
template <class Scalar>
mapped_cloud<strided_points<Scalar>> map_records(const std::string& file, const strided_points<Scalar>& layout,
                                                 std::size_t header = 0) {
  return detail::records_of(std::make_shared<const mapped_file>(file), layout, header);
}

namespace detail {

/// The records of a mapped PCD file: where its coordinates are.
struct pcd_layout {
  std::shared_ptr<const mapped_file> file;
  std::size_t before = 0;  // bytes of the header
  std::uint32_t offset[3] = {}, step = 0;
  std::size_t count = 0;
  std::optional<io::viewpoint> viewpoint;
};
pcd_layout pcd_layout_of(const std::string& file, std::size_t scalar);

}  // namespace detail

/// A PCD file with DATA binary, whose x, y, z are Scalars. Throws std::runtime_error as load_pcd, and for any other
/// kind of PCD file.
template <class Scalar = float>
mapped_cloud<strided_points<Scalar>> map_pcd(const std::string& file) {
  const detail::pcd_layout at = detail::pcd_layout_of(file, sizeof(Scalar));
  strided_points<Scalar> layout;
  for (int axis = 0; axis < 3; ++axis) layout.offset[axis] = at.offset[axis];
  layout.step = at.step;
  layout.count = at.count;
  mapped_cloud<strided_points<Scalar>> made = detail::records_of(at.file, layout, at.before);
  made.viewpoint = at.viewpoint;
  return made;
}

}  // namespace clearance::io
