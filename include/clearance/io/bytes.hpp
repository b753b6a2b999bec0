// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Numbers as bytes, lowest byte first, whatever the byte order of the machine.

#include <clearance/io/error.hpp>

#include <bit>
#include <concepts>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace clearance::io {

static_assert(std::numeric_limits<float>::is_iec559 && std::numeric_limits<double>::is_iec559);

/// Appends numbers to a string.
class byte_writer {
 public:
  template <std::unsigned_integral T>
  void put(T value) {
    for (std::size_t k = 0; k < sizeof(T); ++k) bytes_ += char(std::uint8_t(value >> 8 * k));
  }
  void put(float value) { put(std::bit_cast<std::uint32_t>(value)); }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  void put(std::string_view text) { bytes_ += text; }

  void reserve(std::size_t count) { bytes_.reserve(count); }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Takes numbers off the front. Where too few bytes are left, it refuses with the file's name.
class byte_reader {
 public:
  byte_reader(std::string_view bytes, const std::string& file) : rest_(bytes), file_(&file) {}

  template <class T>
  T take() {
    if constexpr (std::same_as<T, float>) {
      return std::bit_cast<float>(take<std::uint32_t>());
    } else if constexpr (std::same_as<T, double>) {
      return std::bit_cast<double>(take<std::uint64_t>());
    } else {
      T value = 0;
      const std::string_view from = take(sizeof(T));
      for (std::size_t k = 0; k < sizeof(T); ++k) value = T(value | T(T(std::uint8_t(from[k])) << 8 * k));
      return value;
    }
  }
  std::string_view take(std::size_t count) {
    if (count > rest_.size()) refuse(*file_, "ends in the middle of a record");
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }
  std::size_t left() const { return rest_.size(); }

 private:
  std::string_view rest_;
  const std::string* file_;
};

}  // namespace clearance::io
