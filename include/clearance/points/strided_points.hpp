// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud in records of any layout, such as those of ROS and PCL.

#include <clearance/ground/read_only.hpp>
#include <clearance/points/point_filter.hpp>

#include <algorithm>
#include <cstring>

namespace clearance {

/// Records of any size with x, y, z at any byte offset, aligned or not: a ROS PointCloud2 (little-endian), a PCL array.
template <class Scalar = float>
struct strided_points {
  static_assert(std::is_same_v<Scalar, float> || std::is_same_v<Scalar, double>,
                "PointCloud2 coordinates are FLOAT32 or FLOAT64");
  using can = clearance::can<sources::fetched, sources::unfiltered, sources::filtered, sources::copied,
                             sources::checked, sources::rounded>;

  const std::byte* data = nullptr;
  std::size_t count = 0;
  std::uint32_t step = 0;               ///< Bytes from one record to the next (ROS: point_step).
  std::uint32_t offset[3] = {0, 4, 8};  ///< Where x, y and z begin in a record, bytes.
  std::uint32_t width = 0;              ///< Records per row, if rows are padded; 0: all records follow one another.
  std::size_t row_step = 0;             ///< Bytes from one row to the next, if `width` is not 0.
  vec3 origin = {0, 0, 0};              ///< Subtracted from doubles before they become floats.
  point_filter filter = {};
  double off = 0;  ///< How far positions may be from their points already, metres.

  CLEARANCE_HD std::size_t size() const { return count; }
  CLEARANCE_HD sample operator[](std::size_t i) const {
    const std::byte* record = data + (width == 0 ? i * step : i / width * row_step + i % width * step);
    return filter(
        {load(record + offset[0], origin.x), load(record + offset[1], origin.y), load(record + offset[2], origin.z)});
  }

  /// Four records' coordinates; see `fetched_source`.
  struct four {
    Scalar f[12];
  };
  CLEARANCE_HD bool fetches() const {
    const auto odd = reinterpret_cast<std::uintptr_t>(data) | step | offset[0] | offset[1] | offset[2];
    return width == 0 && odd % alignof(Scalar) == 0;
  }
  using cursor = const std::byte*;
  CLEARANCE_HD cursor seek(std::size_t i) const { return data + i * step; }
  CLEARANCE_HD cursor skip(cursor c, std::size_t n) const { return c + n * step; }
  CLEARANCE_HD four fetch(cursor c) const {
    four r;
    CLEARANCE_UNROLL
    for (int j = 0; j < 4; ++j) {
      CLEARANCE_UNROLL
      for (int k = 0; k < 3; ++k)
        r.f[3 * j + k] = read_only(reinterpret_cast<const Scalar*>(c + std::size_t(j) * step + offset[k]));
    }
    return r;
  }
  CLEARANCE_HD unsigned look(const four& r, std::size_t, vec3 (&out)[4]) const {
    const real minus[3] = {origin.x, origin.y, origin.z};
    real f[12];
    CLEARANCE_UNROLL
    for (int k = 0; k < 12; ++k) f[k] = real(r.f[k] - minus[k % 3]);
    return filter.look(f, out);
  }

  CLEARANCE_HD bool unfiltered() const { return filter.plain(); }

  std::span<const std::byte> bytes() const { return bytes(0, count); }
  /// The memory that points `begin` to `end - 1` need: up to the last coordinate, because nothing behind need be there.
  std::span<const std::byte> bytes(std::size_t begin, std::size_t end) const {
    if (begin == end) return {};
    const std::size_t first = width == 0 ? begin * step : begin / width * row_step;
    const std::size_t record = std::max({offset[0], offset[1], offset[2]}) + sizeof(Scalar);
    if (width == 0) return {data + first, (end - 1 - begin) * step + record};
    const std::size_t last = end - 1, rows = last / width - begin / width;
    const std::size_t above =
        rows == 0 ? 0 : (rows - 1) * row_step + (width - std::size_t(1)) * step;  // or it ends later
    return {data + first, std::max(above, rows * row_step + last % width * step) + record};
  }
  strided_points at(const std::byte* copy) const {
    strided_points moved = *this;
    moved.data = copy;
    return moved;
  }
  /// See `rounding_of`. Coordinates may lie beyond a record's step: x, y and z in three arrays are records, too.
  void check() const {
    filter.check();
    if (!is_finite(origin)) detail::refuse_source("a cloud's origin is not finite");
    if (count == 0) return;
    const bool apart = count == 1 || (step != 0 && (width == 0 || count <= width || row_step != 0));
    if (data == nullptr || !apart)
      detail::refuse_source(data == nullptr
                                ? "a cloud of " + std::to_string(count) + " records has none: they are null"
                                : "a cloud's " + std::to_string(count) + " records lie on one another (step " +
                                      std::to_string(step) + ", row_step " + std::to_string(row_step) + ")");
  }
  /// For a double less the origin: 2^-53, and 2^-24 when it becomes a float.
  position_error rounding() const {
    const bool as_they_are = std::is_same_v<Scalar, float> && origin == vec3{0, 0, 0};
    return {off, as_they_are ? 0 : 0x1.00001p-24};
  }

 private:
  // Byte by byte: a record of 18 or 22 bytes puts floats at odd addresses, which a GPU cannot load.
  CLEARANCE_HD static real load(const std::byte* from, real minus) {
    Scalar s;
    if (reinterpret_cast<std::uintptr_t>(from) % alignof(Scalar) == 0)
      s = read_only(reinterpret_cast<const Scalar*>(from));  // otherwise compilers merge both loads into the slow one
    else
      memcpy(&s, from, sizeof s);
    return real(s - minus);
  }
};

static_assert(fetched_source<strided_points<float>> && fetched_source<strided_points<double>> &&
              unfiltered_source<strided_points<float>>);

}  // namespace clearance
