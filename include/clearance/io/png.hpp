// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// stb_image is a C header that carries its own implementation. Its functions are made static and are put into a
// namespace of ours, so that a program may use its own copy, with its own settings, before or after this header.

#include <clearance/io/depth.hpp>
#include <clearance/io/png_rows.hpp>

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

#pragma push_macro("STBI_INCLUDE_STB_IMAGE_H")
#pragma push_macro("STBI_ASSERT")
#pragma push_macro("STBIDEF")
#pragma push_macro("STB_IMAGE_IMPLEMENTATION")
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
#pragma pop_macro("STBI_INCLUDE_STB_IMAGE_H")
#undef STBI_ASSERT
#pragma pop_macro("STBI_ASSERT")
#undef STBIDEF
#pragma pop_macro("STBIDEF")
#undef STB_IMAGE_IMPLEMENTATION
#pragma pop_macro("STB_IMAGE_IMPLEMENTATION")

namespace clearance::io {

// Static, because they call static functions: each translation unit has its own.

/// Reads a PNG file from memory; `file` is its name in the frame and in errors.
[[maybe_unused]] static depth_frame read_png(std::string_view bytes, const std::string& file,
                                             const read_limits& limits = {}) {
  const png_image image = check_depth_png(bytes, file, limits);
  const std::size_t size = png_raw_bytes(image);
  if (size > INT_MAX || image.packed.size() > INT_MAX) refuse(file, "is larger than 2 GiB");
  std::string raw(size, '\0');  // no more, whatever the data unfold to
  int unpacked = -1;
  try {
    unpacked = stb::stbi_zlib_decode_buffer(raw.data(), int(size), image.packed.data(), int(image.packed.size()));
  } catch (const std::logic_error&) {  // STBI_ASSERT
  }
  if (unpacked < 0 || std::size_t(unpacked) != size)
    refuse(file, "the PNG image is damaged (its data are not those of " + std::to_string(image.width) + "x" +
                     std::to_string(image.height) + " pixels)");
  if (image.packed.size() < 4 ||
      png_number(std::string_view(image.packed).substr(image.packed.size() - 4)) != adler32(raw))
    refuse(file, "the PNG image is damaged (the checksum of its data does not match)");
  return {file, png_pixels(image, raw, file), image.width, image.height};
}

/// Reads a depth frame from a 16-bit grey PNG. Throws std::runtime_error for any other PNG, and for a damaged or
/// truncated one.
[[maybe_unused]] static depth_frame load_png(const std::string& file, const read_limits& limits = {}) {
  return within_memory(file, [&] { return read_png(read_bytes(file, limits), file, limits); });
}

}  // namespace clearance::io
