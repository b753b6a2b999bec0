// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Makes numbers and text of an input's bytes, for targets that write files in several encodings.

#include "fuzz/fuzz.hpp"

#include <bit>
#include <charconv>
#include <cmath>

namespace fuzz {

/// The bytes of an input, one number after another; zeros after its end.
class given {
 public:
  explicit given(std::string_view input) : rest_(input) {}

  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const auto first = std::uint8_t(rest_.front());
    rest_.remove_prefix(1);
    return first;
  }
  /// Mostly an eighth of a small whole number; sometimes any float at all, or a double between floats.
  double coordinate(bool doubles) {
    const std::uint8_t kind = byte();
    if (kind < 224) return (int(kind) - 112) / 8.0;
    std::uint32_t bits = 0;
    for (int k = 0; k < 4; ++k) bits = bits << 8 | byte();
    const double value = std::bit_cast<float>(bits);
    return doubles && kind >= 240 ? value * (1 + 0x1p-40) : value;
  }

 private:
  std::string_view rest_;
};

/// The fewest digits that give the number back.
inline std::string digits(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// A number's bytes, lowest first or highest first.
template <class T>
std::string raw(T value, bool highest_first = false) {
  std::string made(reinterpret_cast<const char*>(&value), sizeof value);
  if (highest_first) std::ranges::reverse(made);
  return made;
}

}  // namespace fuzz
