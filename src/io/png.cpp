// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/png.hpp>

#include "io/png_check.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

namespace {

// Turns the unpacked data of a 16-bit grey PNG into pixels. stb_image could, but it checks neither the checksum nor the
// length of the unpacked data, so damaged data would silently become wrong depths.

/// The pixels of an image in one interlacing pass: the first one, and the steps to the next.
struct png_pass {
  std::size_t x, y, across, down;

  std::size_t width(const png_image& image) const {
    return x < image.width ? (image.width - x + across - 1) / across : 0;
  }
  std::size_t height(const png_image& image) const {
    return y < image.height ? (image.height - y + down - 1) / down : 0;
  }
  /// Every row begins with a byte for its filter. A pass without pixels has no rows.
  std::size_t bytes(const png_image& image) const { return width(image) ? height(image) * (2 * width(image) + 1) : 0; }
};

std::vector<png_pass> png_passes(const png_image& image) {
  if (!image.interlaced) return {{0, 0, 1, 1}};
  return {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4}, {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
}

std::size_t png_raw_bytes(const png_image& image) {
  std::size_t bytes = 0;
  for (const png_pass& pass : png_passes(image)) bytes += pass.bytes(image);
  return bytes;
}

/// Undoes the filter of a row; `row[-1]` names the filter. `above` is null for the first row.
void png_unfilter(std::uint8_t* row, const std::uint8_t* above, std::size_t bytes, const std::string& file) {
  const auto each = [&](auto predicted) {
    for (std::size_t i = 0; i < bytes; ++i) {
      const int left = i > 1 ? row[i - 2] : 0, up = above ? above[i] : 0, corner = above && i > 1 ? above[i - 2] : 0;
      row[i] = std::uint8_t(row[i] + predicted(left, up, corner));
    }
  };
  switch (row[-1]) {
    case 0:
      return;
    case 1:
      return each([](int left, int, int) { return left; });
    case 2:
      return each([](int, int up, int) { return up; });
    case 3:
      return each([](int left, int up, int) { return (left + up) / 2; });
    case 4:
      return each([](int left, int up, int corner) {
        const int guess = left + up - corner;
        const int a = std::abs(guess - left), b = std::abs(guess - up), c = std::abs(guess - corner);
        return a <= b && a <= c ? left : b <= c ? up : corner;
      });
    default:
      refuse(file, "the PNG image is damaged (a row has the unknown filter " + std::to_string(row[-1]) + ")");
  }
}

/// The pixels row by row; `raw` holds png_raw_bytes bytes.
std::vector<std::uint16_t> png_pixels(const png_image& image, std::string& raw, const std::string& file) {
  std::vector<std::uint16_t> pixels(image.width * image.height);
  auto* at = reinterpret_cast<std::uint8_t*>(raw.data());
  for (const png_pass& pass : png_passes(image)) {
    const std::size_t width = pass.width(image), height = width ? pass.height(image) : 0;
    for (std::size_t y = 0; y < height; ++y, at += 2 * width + 1) {
      png_unfilter(at + 1, y ? at - 2 * width : nullptr, 2 * width, file);
      std::uint16_t* to = pixels.data() + (pass.y + y * pass.down) * image.width + pass.x;
      for (std::size_t x = 0; x < width; ++x) to[x * pass.across] = std::uint16_t(at[2 * x + 1] << 8 | at[2 * x + 2]);
    }
  }
  return pixels;
}

}  // namespace

}  // namespace clearance::io

// stb_image is a C header that carries its own implementation. Its functions are made static and are put into a
// namespace of ours, so that a program may have its own copy, with its own settings.

// Headers that stb_image.h includes come first, so that they do not end up in a namespace.
#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <climits>
#include <stdexcept>

#undef STBI_INCLUDE_STB_IMAGE_H
#undef STBI_ASSERT
#undef STBIDEF
#undef STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STBI_NO_SIMD
// A crafted file must not end the program.
#define STBI_ASSERT(holds) ((holds) ? void() : throw std::logic_error("stb_image: " #holds))
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#if !defined(__clang__)  // clang does not know these
#pragma GCC diagnostic ignored "-Wduplicated-branches"
#pragma GCC diagnostic ignored "-Wuseless-cast"
#endif
#endif
namespace clearance::io::stb {
#if __has_include(<stb/stb_image.h>)
#include <stb/stb_image.h>
#else
#include <stb_image.h>
#endif
}  // namespace clearance::io::stb
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
#undef STB_IMAGE_STATIC
#undef STBI_ONLY_PNG
#undef STBI_NO_STDIO
#undef STBI_NO_SIMD
#undef STBI_NO_JPEG
#undef STBI_NO_BMP
#undef STBI_NO_PSD
#undef STBI_NO_TGA
#undef STBI_NO_GIF
#undef STBI_NO_HDR
#undef STBI_NO_PIC
#undef STBI_NO_PNM
#undef STBI_NO_LINEAR
#undef STBI_NO_ZLIB
#undef STBI_INCLUDE_STB_IMAGE_H
#undef STBI_ASSERT
#undef STBIDEF
#undef STB_IMAGE_IMPLEMENTATION

namespace clearance::io {

int png_unpack(std::string_view packed, std::string& raw) {
  try {
    return stb::stbi_zlib_decode_buffer(raw.data(), int(raw.size()), packed.data(), int(packed.size()));
  } catch (const std::logic_error&) {  // STBI_ASSERT
    return -1;
  }
}

depth_frame read_png(std::string_view bytes, const std::string& file, const read_limits& limits) {
  const png_image image = check_depth_png(bytes, file, limits);
  const std::size_t size = png_raw_bytes(image);
  if (size > INT_MAX || image.packed.size() > INT_MAX) refuse(file, "is larger than 2 GiB");
  std::string raw(size, '\0');  // no more, whatever the data unfold to
  const int unpacked = png_unpack(image.packed, raw);
  if (unpacked < 0 || std::size_t(unpacked) != size)
    refuse(file, "the PNG image is damaged (its data are not those of " + std::to_string(image.width) + "x" +
                     std::to_string(image.height) + " pixels)");
  if (image.packed.size() < 4 ||
      png_number(std::string_view(image.packed).substr(image.packed.size() - 4)) != adler32(raw))
    refuse(file, "the PNG image is damaged (the checksum of its data does not match)");
  return {file, png_pixels(image, raw, file), image.width, image.height};
}

depth_frame load_png(const std::string& file, const read_limits& limits) {
  return within_memory(file, [&] { return read_png(read_bytes(file, limits), file, limits); });
}

}  // namespace clearance::io
