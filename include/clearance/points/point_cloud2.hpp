// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A ROS PointCloud2 as a point source, without ROS.

#include <clearance/ground/borrowed.hpp>
#include <clearance/points/strided_points.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <ranges>
#include <stdexcept>
#include <string>
#include <string_view>

namespace clearance {

// Where the rows of a ROS message begin: of a PointCloud2, and of an Image.

/// Bytes from one row to the next: `said`, the message's own step, where rows of `row_bytes` fit into the `held` bytes
/// so. Where they do not, and the message holds its rows and nothing else, they follow one another: drivers write 0,
/// another message's step, or all bytes of a cloud. No value if nothing fits. Of one row the step is not read.
inline std::optional<std::uint64_t> row_step(std::uint64_t rows, std::uint64_t row_bytes, std::uint64_t said,
                                             std::uint64_t held) {
  if (rows == 0 || row_bytes == 0) return row_bytes;
  if (held < row_bytes) return std::nullopt;
  if (rows == 1) return row_bytes;
  if (said >= row_bytes && said <= (held - row_bytes) / (rows - 1)) return said;
  if (held % rows == 0 && held / rows == row_bytes) return row_bytes;
  return std::nullopt;
}

/// A PointField: where a number lies in a point's bytes, and of which type it is.
struct point_field {
  static constexpr std::uint8_t float32 = 7, float64 = 8;

  borrowed_text name;
  std::uint32_t offset = 0;  ///< Bytes.
  std::uint8_t datatype = float32;
  std::uint32_t count = 1;
};

/// What a PointCloud2 says, by the same names, if you have no such message.
struct point_cloud2 {
  borrowed<point_field> fields;
  std::uint32_t height = 1, width = 0;
  bool is_bigendian = false;
  std::uint32_t point_step = 0, row_step = 0;  ///< Bytes. Where row_step cannot be, rows may follow one another
                                               ///< (`clearance::row_step`).
  borrowed<std::byte> data;
};

namespace detail {

[[noreturn]] inline void refuse_cloud(const std::string& why) {
  throw std::invalid_argument("clearance: the cloud " + why);
}

/// The one field of this name. Throws if there is none, or if it holds no number of the wanted type.
template <class Message>
point_field field_of(const Message& message, std::string_view name, std::uint8_t wanted) {
  static constexpr const char* types[] = {"INT8", "UINT8", "INT16", "UINT16", "INT32", "UINT32", "FLOAT32", "FLOAT64"};
  const std::string wanted_field = "field " + std::string(name);
  std::string others;
  point_field found;
  found.count = ~0u;
  for (const auto& field : message.fields) {
    others += (others.empty() ? "" : ", ") + std::string(field.name);
    if (field.name != name) continue;
    if (found.count != ~0u) refuse_cloud("has two of the " + wanted_field);
    found = {name, std::uint32_t(field.offset), std::uint8_t(field.datatype), std::min(std::uint32_t(field.count), 9u)};
  }
  if (found.count == ~0u)
    refuse_cloud("has no " + wanted_field + " (it has: " + (others.empty() ? "none" : others) + ")");
  if (found.datatype != wanted) {
    const bool known = found.datatype >= 1 && found.datatype <= 8;
    const bool first = name == "x" && found.datatype == point_field::float64;
    const char* const hint = first ? "; point_cloud2_view<double> reads it" : "";
    refuse_cloud("holds its " + wanted_field + " as " +
                 (known ? types[found.datatype - 1] : "datatype " + std::to_string(found.datatype)) + ", not as " +
                 types[wanted - 1] + hint);
  }
  if (found.count > 1) refuse_cloud("holds several numbers in its " + wanted_field);
  return found;
}

}  // namespace detail

/// The points of a PointCloud2, read where they lie: records with FLOAT32 x, y and z (with `double`: FLOAT64) at any
/// offsets, in rows with or without padding. A message is ROS's own of any version, a `point_cloud2`, or anything with
/// these members; its bytes must outlive the view. Throws std::invalid_argument, with a sentence, if x, y or z is
/// missing or of another type, if a size contradicts another one, or if numbers are big-endian.
template <class Scalar = float, class Message>
strided_points<Scalar> point_cloud2_view(Message&& message, const point_filter& filter = {}) {
  static_assert(std::is_lvalue_reference_v<Message> || std::ranges::borrowed_range<decltype(message.data)>,
                "the message would be gone before its view is read; give it a name");
  constexpr std::uint8_t wanted = std::is_same_v<Scalar, float> ? point_field::float32 : point_field::float64;
  if (message.is_bigendian) detail::refuse_cloud("is big-endian");
  const std::span<const std::byte> data = std::as_bytes(std::span(message.data));
  const std::uint64_t rows = message.height, columns = message.width, step = message.point_step;

  strided_points<Scalar> view;
  for (std::size_t k = 0; k < 3; ++k) {
    const point_field field = detail::field_of(message, std::string_view("xyz").substr(k, 1), wanted);
    if (field.offset + sizeof(Scalar) > step)
      detail::refuse_cloud("has its field " + std::string(field.name) + " at byte " + std::to_string(field.offset) +
                           ", beyond its point_step of " + std::to_string(step) + " bytes");
    view.offset[k] = field.offset;
  }

  const std::uint64_t row_bytes = columns * step, said = message.row_step;
  const auto row_step = clearance::row_step(rows, row_bytes, said, data.size());
  if (!row_step)
    detail::refuse_cloud("says " + std::to_string(rows) + " x " + std::to_string(columns) + " points of " +
                         std::to_string(step) + " bytes" +
                         (rows > 1 ? ", in rows of " + std::to_string(said) + " bytes (row_step)" : "") +
                         ", but holds " + std::to_string(data.size()) + " bytes");

  view.data = data.data();
  view.count = rows * columns;
  view.step = std::uint32_t(step);
  if (*row_step != row_bytes) {
    view.width = std::uint32_t(columns);
    view.row_step = *row_step;
  }
  view.filter = filter;
  return view;
}

}  // namespace clearance
