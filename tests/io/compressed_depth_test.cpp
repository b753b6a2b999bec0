// SPDX-License-Identifier: BSD-3-Clause
#include "io/png_check.hpp"
#include "io/scratch_file.hpp"
#include "support/laws.hpp"

#include <clearance/io/bytes.hpp>
#include <clearance/io/compressed_depth.hpp>

#include <cstring>

namespace compressed_depth_test {

using namespace testing;
using namespace clearance;

namespace {

/// RVL as its paper writes it, with a difference of 16 bits from the last pixel that was not 0.
std::string rvl(const std::vector<std::uint16_t>& pixels) {
  std::vector<std::uint8_t> nibbles;
  const auto put = [&](std::uint32_t value) {
    do {
      nibbles.push_back(std::uint8_t((value & 7) | (value > 7 ? 8 : 0)));
      value >>= 3;
    } while (value != 0);
  };
  std::int32_t last = 0;
  for (std::size_t i = 0; i < pixels.size();) {
    std::size_t zeros = i;
    while (zeros < pixels.size() && pixels[zeros] == 0) ++zeros;
    std::size_t end = zeros;
    while (end < pixels.size() && pixels[end] != 0) ++end;
    put(std::uint32_t(zeros - i)), put(std::uint32_t(end - zeros));
    for (i = zeros; i < end; ++i) {
      const std::int32_t step = pixels[i] - last;
      put(step < 0 ? 2 * std::uint32_t(-step) - 1 : 2 * std::uint32_t(step));
      last = pixels[i];
    }
  }
  nibbles.resize((nibbles.size() + 7) / 8 * 8);
  io::byte_writer out;
  for (std::size_t k = 0; k < nibbles.size(); k += 8) {
    std::uint32_t word = 0;
    for (std::size_t n = 0; n < 8; ++n) word = word << 4 | nibbles[k + n];
    out.put(word);
  }
  return out.bytes();
}

std::string big(std::uint32_t value) { return {char(value >> 24), char(value >> 16), char(value >> 8), char(value)}; }

std::string chunk(const std::string& name, const std::string& data) {
  return big(std::uint32_t(data.size())) + name + data + big(io::png_crc(name + data));
}

/// A PNG whose data are stored, not packed: less than 64 KiB of them.
std::string png(const std::vector<std::uint16_t>& pixels, std::uint32_t width, std::uint32_t height) {
  std::string rows;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (i % width == 0) rows += '\0';
    rows += char(pixels[i] >> 8), rows += char(pixels[i]);
  }
  const auto size = std::uint16_t(rows.size()), not_size = std::uint16_t(~size);
  const std::string packed = std::string("\x78\x01\x01", 3) + char(size) + char(size >> 8) + char(not_size) +
                             char(not_size >> 8) + rows + big(io::adler32(rows));
  return std::string("\x89PNG\r\n\x1a\n") + chunk("IHDR", big(width) + big(height) + char(16) + std::string(4, '\0')) +
         chunk("IDAT", packed) + chunk("IEND", "");
}

std::string head(float a = 0, float b = 0) {
  io::byte_writer out;
  out.put(std::uint32_t(0)), out.put(a), out.put(b);
  return out.bytes();
}

std::string sized(std::uint32_t width, std::uint32_t height) {
  io::byte_writer out;
  out.put(width), out.put(height);
  return out.bytes();
}

std::vector<std::uint16_t> some_pixels(dice& d, std::size_t n) {
  std::vector<std::uint16_t> pixels(n);
  std::uint32_t at = d.below(65536);
  for (auto& pixel : pixels) {
    const unsigned kind = d.below(12);
    at = kind == 0 ? d.below(65536) : at + d.below(9) - 4;
    pixel = kind < 3 ? 0 : std::uint16_t(at);
  }
  return pixels;
}

io::compressed_depth read(const std::string& format, const std::string& bytes) {
  return io::read_compressed_depth(format, bytes, "m");
}
std::string refused(const std::string& format, const std::string& bytes) {
  return refusal([&] { read(format, bytes); });
}
bool says(const std::string& text, const std::string& part) {
  INFO("\"" << text << "\" should say \"" << part << "\"");
  CHECK(text.find(part) != std::string::npos);
  return true;
}

}  // namespace

TEST_CASE("Compressed depths are those that were packed, by PNG and by RVL, of any size and values") {
  dice d(3);
  for (int trial = 0; trial < 60; ++trial) {
    const std::uint32_t width = 1 + d.below(40), height = 1 + d.below(30);
    auto pixels = some_pixels(d, std::size_t(width) * height);
    if (trial == 0) std::ranges::fill(pixels, std::uint16_t(0));
    if (trial == 1) std::ranges::fill(pixels, std::uint16_t(65535));
    for (const std::string encoding : {"16UC1", "mono16"})
      for (const auto& [format, bytes] :
           {std::pair{encoding + "; compressedDepth", head() + png(pixels, width, height)},
            std::pair{encoding + "; compressedDepth png", head(7, -1) + png(pixels, width, height)},
            std::pair{encoding + "; png compressed ", png(pixels, width, height)},
            std::pair{encoding + "; compressedDepth rvl", head() + sized(width, height) + rvl(pixels)}}) {
        const io::compressed_depth made = read(format, bytes);
        INFO(format);
        CHECK(made.frame.pixels == pixels);
        CHECK((made.frame.width == width && made.frame.height == height && made.metres.empty()));
      }
  }
}

TEST_CASE("Of inverse depths the depth that was measured is within what is said, never nearer, and 0 is none") {
  dice d(4);
  for (const float step : {100.0f, 20.0f})
    for (const float farthest : {10.0f, 100.0f}) {
      // As the writer has it: quantised with `step`, up to `farthest`.
      const float a = step * (step + 1), b = 1 - a / farthest;
      std::vector<float> depths(400);
      for (float& z : depths) z = d.below(10) == 0 ? NAN : std::exp(d.uniform(std::log(0.2), std::log(farthest * 1.1)));
      std::vector<std::uint16_t> packed;
      for (const float z : depths) {
        const float n = a / z + b;
        packed.push_back(z < farthest && n < 65536 ? std::uint16_t(n) : std::uint16_t(0));
      }
      for (const bool by_rvl : {false, true}) {
        const auto made = by_rvl ? read("32FC1; compressedDepth rvl", head(a, b) + sized(20, 20) + rvl(packed))
                                 : read("32FC1; compressedDepth", head(a, b) + png(packed, 20, 20));
        REQUIRE((made.metres.size() == 400 && made.short_by.size() == 400));
        std::size_t measured = 0;
        for (std::size_t i = 0; i < 400; ++i) {
          CHECK(std::isnan(made.metres[i]) == (packed[i] == 0));
          if (packed[i] == 0) continue;
          ++measured;
          CHECK((depths[i] <= made.metres[i] * (1 + 1e-5f) && depths[i] >= made.metres[i] - made.short_by[i]));
          CHECK(made.short_by[i] <= 1.1f * made.metres[i] * made.metres[i] / a + 1e-6f);
        }
        CHECK(measured > 200);
      }
    }
}

TEST_CASE("What is no depth, and what is damaged, is a sentence") {
  const std::vector<std::uint16_t> pixels{0, 1, 258, 65535, 1000, 7};
  const std::string depth = "16UC1; compressedDepth", packed = rvl(pixels);
  for (const std::string format : {"bgr8; jpeg compressed bgr8", "jpeg", "", "16UC1", "16UC1; jpeg compressed ",
                                   "32FC1; png compressed ", "8UC1; compressedDepth"}) {
    CHECK(!io::depth_format(format));
    says(refused(format, head() + png(pixels, 3, 2)), "which is no depth");
  }
  says(refused(depth, head().substr(0, 11)), "ends in the middle");
  says(refused(depth, head()), "is not a PNG image");
  says(refused(depth, head() + png(pixels, 3, 2).substr(0, 60)), "cut short");
  const std::string by_rvl = depth + " rvl";
  says(refused(by_rvl, head() + sized(3, 2).substr(0, 5)), "ends in the middle");
  says(refused(by_rvl, head() + sized(3, 3) + packed), "");
  says(refused(by_rvl, head() + sized(3, 1) + packed), "more pixels than its size says");
  says(refused(by_rvl, head() + sized(0, 2) + packed), "no pixels");
  says(refused(by_rvl, head() + sized(0xffffffff, 0xffffffff) + packed), "more than the limit of 1024 MiB");
  says(refused(by_rvl, head() + sized(3, 2) + std::string(16, '\xff')), "a number is too long");
  for (std::size_t n = 0; n + 4 < packed.size(); n += 4)
    says(refused(by_rvl, head() + sized(3, 2) + packed.substr(0, n)), "ends in the middle");
  for (const auto& [a, b] : {std::pair{0.0f, 0.0f}, {-1.0f, 0.0f}, {NAN, 0.0f}, {INFINITY, 0.0f}, {1.0f, NAN}})
    says(refused("32FC1; compressedDepth", head(a, b) + png(pixels, 3, 2)), "parameters that no depth follows from");
}

}  // namespace compressed_depth_test
