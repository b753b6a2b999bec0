// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/compressed_depth.hpp>

#include <clearance/io/bytes.hpp>
#include <clearance/io/png.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace clearance::io {

namespace {

// RVL, a lossless code of depth images: Wilson, "Fast lossless depth image compression" (2017).

/// Takes numbers of nibbles: three bits each, the lowest first; a fourth says that more follow. A word of four bytes
/// has eight nibbles, the highest first.
class rvl_reader {
 public:
  rvl_reader(std::string_view bytes, const std::string& file) : from_(bytes, file), file_(&file) {}

  std::uint32_t next() {
    std::uint32_t value = 0;
    for (int shift = 0;; shift += 3) {
      if (left_ == 0) {
        word_ = from_.take<std::uint32_t>();
        left_ = 8;
      }
      const std::uint32_t nibble = word_ >> 28;
      word_ <<= 4;
      --left_;
      if (shift > 27) refuse(*file_, "the RVL image is damaged (a number is too long)");
      value |= (nibble & 7u) << shift;
      if ((nibble & 8u) == 0) return value;
    }
  }

 private:
  byte_reader from_;
  const std::string* file_;
  std::uint32_t word_ = 0;
  int left_ = 0;
};

/// The pixels of an image: runs of zeros and runs of differences by turns. Throws std::runtime_error, which names
/// `file`, for what is damaged, truncated, or larger than the limits.
depth_frame read_rvl(std::string_view bytes, std::size_t width, std::size_t height, const std::string& file,
                     const read_limits& limits = {}) {
  if (width == 0 || height == 0) refuse(file, "the RVL image has no pixels");
  if (width > limits.unfolded / 2 / height)
    refuse(file, "the RVL image says " + std::to_string(width) + "x" + std::to_string(height) +
                     " pixels, more than the limit of " + mebibytes(limits.unfolded) + " (read_limits::unfolded)");

  depth_frame made{file, {}, width, height};
  std::vector<std::uint16_t>& pixels = made.pixels;
  const std::size_t count = width * height;
  rvl_reader from(bytes, file);
  const auto run = [&] {
    const std::uint32_t length = from.next();
    if (length > count - pixels.size())
      refuse(file, "the RVL image is damaged (it has more pixels than its size says)");
    return length;
  };

  std::uint32_t last = 0;
  for (bool zeros = true; pixels.size() < count; zeros = !zeros) {
    const std::uint32_t length = run();
    if (zeros) {
      pixels.resize(pixels.size() + length);
      continue;
    }
    for (std::uint32_t k = 0; k < length; ++k) {
      const std::uint32_t code = from.next();  // 0, -1, 1, -2, ...
      last += (code >> 1) ^ (0u - (code & 1u));
      pixels.push_back(std::uint16_t(last));
    }
  }
  return made;
}

}  // namespace

std::optional<compressed_format> depth_format(std::string_view format) {
  const std::size_t at = format.find(';');
  const std::string_view encoding = format.substr(0, at), how = at == format.npos ? "" : format.substr(at + 1);
  compressed_format made{.in_metres = encoding == "32FC1"};
  if (encoding != "16UC1" && encoding != "mono16" && !made.in_metres) return {};
  made.headed = how.find("compressedDepth") != how.npos;
  made.rvl = how.find("rvl") != how.npos;
  if (!made.headed && (made.in_metres || how.find("png") == how.npos)) return {};
  return made;
}

compressed_depth read_compressed_depth(std::string_view format, std::string_view bytes, const std::string& file,
                                       const read_limits& limits) {
  const auto known = depth_format(format);
  if (!known) refuse(file, "the image's format is " + io::quoted(format) + ", which is no depth");
  byte_reader from(bytes, file);
  float a = 0, b = 0;
  if (known->headed) {
    from.take<std::uint32_t>();
    a = from.take<float>();
    b = from.take<float>();
  }

  compressed_depth made;
  if (known->rvl) {
    const auto width = from.take<std::uint32_t>(), height = from.take<std::uint32_t>();
    made.frame = read_rvl(from.take(from.left()), width, height, file, limits);
  } else {
    made.frame = read_png(from.take(from.left()), file, limits);
  }
  if (!known->in_metres) return made;
  if (!(a > 0) || !std::isfinite(a) || !std::isfinite(b))
    refuse(file, "the image has inverse depths, and parameters that no depth follows from (" + std::to_string(a) +
                     " and " + std::to_string(b) + ")");

  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  for (const std::uint16_t n : made.frame.pixels) {
    const float depth = a / (float(n) - b);
    const bool measured = n != 0 && depth > 0 && std::isfinite(depth);
    made.metres.push_back(measured ? depth : none);
    // The writer rounds a / depth + b down, with floats, which lose less than this.
    const double least = double(a) / (double(n) + 1 + 0x1p-6 - double(b));
    made.short_by.push_back(
        measured ? std::nextafter(float(double(depth) - least), std::numeric_limits<float>::infinity()) : 0);
  }
  return made;
}

}  // namespace clearance::io
