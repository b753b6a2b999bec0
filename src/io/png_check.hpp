// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Checks a PNG file before its data are unpacked.

#include <clearance/io/error.hpp>

#include <array>
#include <cctype>
#include <cstdint>
#include <string>
#include <string_view>

namespace clearance::io {

/// Table k is of a byte that k others follow.
inline constexpr auto png_crc_tables = [] {
  std::array<std::array<std::uint32_t, 256>, 8> tables{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int bit = 0; bit < 8; ++bit) c = (c & 1u) ? 0xEDB88320u ^ (c >> 1) : c >> 1;
    tables[0][i] = c;
  }
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t i = 0; i < 256; ++i) tables[k][i] = tables[0][tables[k - 1][i] & 255u] ^ (tables[k - 1][i] >> 8);
  return tables;
}();

/// The checksum of a PNG chunk's name and data. Eight bytes at once: Kounavis & Berry (2005), "slicing by 8".
constexpr std::uint32_t png_crc(std::string_view bytes) {
  const auto& t = png_crc_tables;
  std::uint32_t c = 0xFFFFFFFFu;
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    const auto at = [&](std::size_t k) { return std::uint32_t(std::uint8_t(bytes[i + k])); };
    c ^= at(0) | at(1) << 8 | at(2) << 16 | at(3) << 24;
    c = t[7][c & 255u] ^ t[6][c >> 8 & 255u] ^ t[5][c >> 16 & 255u] ^ t[4][c >> 24] ^ t[3][at(4)] ^ t[2][at(5)] ^
        t[1][at(6)] ^ t[0][at(7)];
  }
  for (; i < bytes.size(); ++i) c = t[0][(c ^ std::uint8_t(bytes[i])) & 255u] ^ (c >> 8);
  return c ^ 0xFFFFFFFFu;
}

/// zlib's checksum of the unpacked data.
constexpr std::uint32_t adler32(std::string_view bytes) {
  std::uint32_t a = 1, b = 0;
  while (!bytes.empty()) {
    const std::string_view piece = bytes.substr(0, 5552);  // as many as cannot overflow
    for (const char byte : piece) b += a += std::uint8_t(byte);
    a %= 65521;
    b %= 65521;
    bytes.remove_prefix(piece.size());
  }
  return b << 16 | a;
}

constexpr std::uint32_t png_number(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char byte : bytes.substr(0, 4)) value = value << 8 | std::uint8_t(byte);
  return value;
}

/// An image whose data are still packed.
struct png_image {
  std::size_t width = 0, height = 0;
  bool interlaced = false;
  std::string packed;  // by zlib
};

/// Refuses anything but a complete, undamaged 16-bit grey PNG whose data suffice for its size.
inline png_image check_depth_png(std::string_view bytes, const std::string& file, const read_limits& limits = {}) {
  using namespace std::string_view_literals;
  constexpr std::string_view signature = "\x89PNG\r\n\x1a\n"sv;
  if (!bytes.starts_with(signature)) refuse(file, "is not a PNG image");
  bytes.remove_prefix(signature.size());

  std::uint64_t width = 0, height = 0;
  png_image image;
  bool data_ended = false;
  for (bool first = true;; first = false) {
    if (bytes.size() < 12) refuse(file, "the PNG image is cut short");
    const std::uint64_t size = png_number(bytes);
    const std::string_view name = bytes.substr(4, 4);
    if (size > bytes.size() - 12) refuse(file, "the PNG image is cut short");
    if (png_crc(bytes.substr(4, 4 + size)) != png_number(bytes.substr(8 + size)))
      refuse(file, "the PNG image is damaged (a checksum does not match)");
    const std::string_view data = bytes.substr(8, size);

    if (first != (name == "IHDR") || (first && size != 13)) refuse(file, "the PNG image has no proper header");
    if (first) {
      width = png_number(data);
      height = png_number(data.substr(4));
      const int depth = std::uint8_t(data[8]), colour = std::uint8_t(data[9]);
      if (depth != 16 || colour != 0) {
        constexpr std::array<const char*, 7> kinds = {
            "grey", "?", "colour", "palette", "grey with alpha", "?", "colour with alpha"};
        refuse(file, "a depth image must be a 16-bit grey PNG, this one is " + std::to_string(depth) + "-bit " +
                         (colour < 7 ? kinds[std::size_t(colour)] : "?"));
      }
      if (width == 0 || height == 0) refuse(file, "the PNG image has no pixels");
      if (data[10] || data[11] || std::uint8_t(data[12]) > 1)
        refuse(file, "the PNG image is packed, filtered or interlaced in a way that is not known");
      image.interlaced = data[12] == 1;
    } else if (name == "IDAT") {
      if (data_ended) refuse(file, "the PNG image has data in two places");
      image.packed += data;
    } else if (name != "IEND" && !std::islower(std::uint8_t(name[0]))) {
      refuse(file, "the PNG image has a chunk " + quoted(name) + ", which no grey image has");
    }
    data_ended |= name != "IDAT" && !image.packed.empty();
    bytes.remove_prefix(12 + size);
    if (name == "IEND") break;
  }

  const std::uint64_t packed = image.packed.size();
  // Deflate packs at most 1032 bytes into one byte.
  if (width > (1u << 24) || height > (1u << 24) || (2 * width + 1) * height > 1032 * packed)
    refuse(file, "the PNG image says " + std::to_string(width) + "x" + std::to_string(height) +
                     " pixels, more than its data can hold");
  if (const std::uint64_t memory = 4 * width * height;
      memory > limits.unfolded)  // of the pixels, and while they are unpacked
    refuse(file, std::to_string(packed) + " bytes unfold to " + std::to_string(width) + "x" + std::to_string(height) +
                     " pixels of " + mebibytes(memory) + ", more than the limit of " + mebibytes(limits.unfolded) +
                     " (read_limits::unfolded), which --unfold-limit of the command raises");
  image.width = std::size_t(width);
  image.height = std::size_t(height);
  return image;
}

/// Unpacks a zlib stream into `raw`, whose size is the most that there may be. Returns the bytes, or -1 if it is
/// damaged.
int png_unpack(std::string_view packed, std::string& raw);

}  // namespace clearance::io
