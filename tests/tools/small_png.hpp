// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/png_check.hpp"

#include <cstdint>
#include <string>

inline std::string chunk(const std::string& name, const std::string& data) {
  const auto big = [](std::uint32_t v) { return std::string{char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; };
  return big(std::uint32_t(data.size())) + name + data + big(clearance::io::png_crc(name + data));
}

/// 2 x 1 pixels with these depths; `depth_bits` is 16, or 8 for what must be refused.
inline std::string png(std::uint16_t left, std::uint16_t right, int depth_bits = 16) {
  std::string row(1, '\0');
  for (const auto d : {left, right})
    row += depth_bits == 16 ? std::string{char(d >> 8), char(d)} : std::string(1, char(d));
  std::uint32_t a = 1, b = 0;
  for (const char c : row) a = (a + std::uint8_t(c)) % 65521, b = (b + a) % 65521;
  const std::string packed = std::string("\x78\x01\x01", 3) + char(row.size()) + '\0' + char(~row.size()) + '\xff' +
                             row + char(b >> 8) + char(b) + char(a >> 8) + char(a);
  return "\x89PNG\r\n\x1a\n" +
         chunk("IHDR", std::string("\0\0\0\2\0\0\0\1", 8) + char(depth_bits) + std::string(4, '\0')) +
         chunk("IDAT", packed) + chunk("IEND", "");
}
