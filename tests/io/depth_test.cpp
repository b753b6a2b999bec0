// SPDX-License-Identifier: BSD-3-Clause
#include "io/png_check.hpp"
#include "io/scratch_file.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

#include <clearance/io/cloud_file.hpp>
#include <clearance/io/png.hpp>

#include <array>
#include <cstdlib>
#include <random>

namespace depth_test {

using namespace clearance;

namespace {

std::string big(std::uint32_t value) { return {char(value >> 24), char(value >> 16), char(value >> 8), char(value)}; }

std::string chunk(const std::string& name, const std::string& data) {
  return big(std::uint32_t(data.size())) + name + data + big(io::png_crc(name + data));
}

/// Stored, not packed: a deflate block of raw bytes.
std::string zlib(const std::string& data) {
  std::uint32_t a = 1, b = 0;
  for (const char c : data) a = (a + std::uint8_t(c)) % 65521, b = (b + a) % 65521;
  const auto size = std::uint16_t(data.size()), not_size = std::uint16_t(~size);
  return std::string("\x78\x01\x01", 3) + char(size) + char(size >> 8) + char(not_size) + char(not_size >> 8) + data +
         big(b << 16 | a);
}

std::string png(std::uint32_t width, std::uint32_t height, int depth, int colour, const std::string& rows) {
  return "\x89PNG\r\n\x1a\n" +
         chunk("IHDR", big(width) + big(height) + char(depth) + char(colour) + std::string(3, '\0')) +
         chunk("IDAT", zlib(rows)) + chunk("IEND", "");
}

// 3 x 2 pixels: 0 1 258, 65535 1000 7
const std::string pixels("\0\0\0\0\1\1\2\0\xff\xff\3\xe8\0\7", 14);

std::string refused(const std::string& bytes) {
  const scratch_file file(".png", bytes);
  return refusal([&] { io::load_png(file.path); });
}

bool contains(const std::string& sentence, const std::string& part) {
  INFO("\"" << sentence << "\" should say \"" << part << "\"");
  CHECK(sentence.find(part) != std::string::npos);
  return true;
}

}  // namespace

TEST_CASE("a 16-bit PNG gives its numbers unchanged, row by row") {
  const scratch_file file(".png", png(3, 2, 16, 0, pixels));
  const io::depth_frame frame = io::load_png(file.path);
  CHECK(frame.width == 3);
  CHECK(frame.height == 2);
  CHECK(frame.pixels == std::vector<std::uint16_t>{0, 1, 258, 65535, 1000, 7});
  CHECK(frame.name == file.path);
}

TEST_CASE("any other PNG is refused by what it is") {
  contains(refused(png(3, 2, 8, 0, std::string(8, '\0'))), "must be a 16-bit grey PNG, this one is 8-bit grey");
  contains(refused(png(1, 1, 16, 2, std::string(7, '\0'))), "16-bit colour");
  contains(refused(png(1, 1, 8, 6, std::string(5, '\0'))), "8-bit colour with alpha");
  contains(refused("P5 3 2 65535\n"), "is not a PNG image");
  contains(refused(""), "is empty (0 bytes)");
  contains(refused(png(0, 2, 16, 0, "")), "has no pixels");
}

TEST_CASE("a PNG cut short or damaged anywhere is refused") {
  const std::string whole = png(3, 2, 16, 0, pixels);
  const auto read = [&](const std::string& bytes) { return refusal([&] { io::read_png(bytes, "fuzz"); }); };
  REQUIRE(read(whole).empty());
  REQUIRE(read(whole + "padding").empty());
  for (std::size_t length = 0; length < whole.size(); ++length) CHECK(!read(whole.substr(0, length)).empty());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = char(changed[i] ^ 0x10);
    CHECK(!read(changed).empty());
  }
}

TEST_CASE("a PNG with right checksums and wrong contents is read or refused, never more") {
  contains(refused(png(16000000, 16000000, 16, 0, pixels)), "more than its data can hold");
  CHECK(!refused(png(3, 3, 16, 0, pixels)).empty());
  std::mt19937 random(11);
  const std::vector<std::uint16_t> right = {0, 1, 258, 65535, 1000, 7};
  int accepted = 0, wrong = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string rows = zlib(pixels);
    for (int k = 0; k <= i % 4; ++k) rows[random() % rows.size()] = char(random());
    const std::string bytes = "\x89PNG\r\n\x1a\n" + chunk("IHDR", big(3) + big(2) + char(16) + std::string(4, '\0')) +
                              chunk("IDAT", rows) + chunk("IEND", "");
    accepted += refusal([&] { wrong += io::read_png(bytes, "fuzz").pixels != right; }).empty();
  }
  CHECK(wrong == 0);
  CHECK(accepted < 100);
}

TEST_CASE("the data of a PNG have the checksum and the length that they say, or are refused") {
  const auto image = [](const std::string& packed) {
    return refused("\x89PNG\r\n\x1a\n" + chunk("IHDR", big(3) + big(2) + char(16) + std::string(4, '\0')) +
                   chunk("IDAT", packed) + chunk("IEND", ""));
  };
  const std::string packed = zlib(pixels);
  CHECK(image(packed).empty());
  for (std::size_t at = 2; at < packed.size(); ++at) {
    std::string changed = packed;
    changed[at] = char(changed[at] ^ 1);
    contains(image(changed), "the PNG image is damaged");
  }
  for (std::size_t length = 0; length < packed.size(); ++length)
    contains(image(packed.substr(0, length)), "the PNG image");
  contains(image(packed + '\0'), "checksum");
  for (const std::size_t more : {1u, 2u, 7u, 14u, 1000u})
    contains(image(zlib(pixels + std::string(more, '\1'))), "not those of 3x2 pixels");
  for (std::size_t less = 1; less <= pixels.size(); ++less)
    contains(image(zlib(pixels.substr(0, pixels.size() - less))), "the PNG image");
  // A megabyte that would become a gigabyte is not unpacked.
  std::string blocks = "\x78\x01";
  for (int k = 0; k < 20; ++k) blocks += std::string("\0\xff\xff\0\0", 5) + std::string(65535, '\0');
  contains(image(blocks), "not those of 3x2 pixels");
  for (int filter = 5; filter < 256; filter += 50)
    contains(image(zlib(char(filter) + pixels.substr(1))), "unknown filter " + std::to_string(filter));
}

TEST_CASE("a PNG has one header, data in one place, and no chunk that its pixels would need") {
  const std::string start = "\x89PNG\r\n\x1a\n", head = big(3) + big(2) + char(16) + std::string(4, '\0'),
                    data = zlib(pixels);
  const auto of = [&](const std::vector<std::string>& chunks) {
    std::string bytes = start;
    for (const auto& each : chunks) bytes += each;
    return refused(bytes);
  };
  const std::string first = chunk("IHDR", head), end = chunk("IEND", ""), half = chunk("IDAT", data.substr(0, 9)),
                    rest = chunk("IDAT", data.substr(9));
  CHECK(of({first, half, rest, end}).empty());
  CHECK(of({first, chunk("gAMA", "1234"), chunk("tEXt", "a"), half, chunk("IDAT", ""), rest, chunk("tIME", "x"), end})
            .empty());
  contains(of({first, half, chunk("tEXt", "a"), rest, end}), "in two places");
  contains(of({first, rest, half, end}), "the PNG image is damaged");
  contains(of({first, first, half, rest, end}), "no proper header");
  contains(of({half, first, rest, end}), "no proper header");
  contains(of({first, end}), "more than its data can hold");
  for (const char* name : {"PLTE", "XXXX", "CgBI"}) contains(of({first, chunk(name, "abc"), half, rest, end}), name);
  for (std::size_t at = 10; at < 13; ++at) {
    std::string other = head;
    other[at] = at == 12 ? '\2' : '\1';
    contains(of({chunk("IHDR", other), half, rest, end}), "in a way that is not known");
  }
}

TEST_CASE("a PNG of any size, with any filters, interlaced or not, gives the numbers that were written") {
  std::mt19937 random(5);
  for (std::size_t width = 1; width <= 10; ++width)
    for (std::size_t height = 1; height <= 10; ++height)
      for (const bool interlaced : {false, true}) {
        std::vector<std::uint16_t> written(width * height);
        for (auto& v : written) v = std::uint16_t(random() % 3 ? 1000 + random() % 300 : random());
        std::string rows;
        // The places of Adam7, as the specification draws them.
        const std::string adam7 = "1646264677777777565656567777777736463646777777775656565677777777";
        for (char pass = '1'; pass <= (interlaced ? '7' : '1'); ++pass) {
          std::vector<std::uint8_t> above;
          for (std::size_t y = 0; y < height; ++y) {
            std::vector<std::uint8_t> row;
            for (std::size_t x = 0; x < width; ++x)
              if (!interlaced || adam7[y % 8 * 8 + x % 8] == pass)
                for (const int v : {written[y * width + x] >> 8, written[y * width + x] & 255})
                  row.push_back(std::uint8_t(v));
            if (row.empty()) continue;
            above.resize(row.size());
            const int filter = int(random() % 5);
            rows += char(filter);
            for (std::size_t i = 0; i < row.size(); ++i) {
              const int a = i > 1 ? row[i - 2] : 0, b = above[i], c = i > 1 ? above[i - 2] : 0, p = a + b - c;
              const int nearest = std::abs(p - a) <= std::abs(p - b) && std::abs(p - a) <= std::abs(p - c) ? a
                                  : std::abs(p - b) <= std::abs(p - c)                                     ? b
                                                                                                           : c;
              rows += char(row[i] - std::array{0, a, b, (a + b) / 2, nearest}[std::size_t(filter)]);
            }
            above = row;
          }
        }
        std::string bytes = "\x89PNG\r\n\x1a\n" +
                            chunk("IHDR", big(std::uint32_t(width)) + big(std::uint32_t(height)) + char(16) +
                                              std::string(3, '\0') + char(interlaced)) +
                            chunk("IDAT", zlib(rows)) + chunk("IEND", "");
        INFO(width << " x " << height << (interlaced ? ", interlaced" : ""));
        CHECK(io::read_png(bytes, "made").pixels == written);
      }
}

TEST_CASE("the PNG and the PCD of one real frame agree in every pixel", "[data]") {
  const std::string folder = testing::data("/clouds/kinect_seq/");
  if (!std::filesystem::exists(folder)) {
    WARN("SKIPPED: no folder " << folder);
    return;
  }
  for (const std::string name :
       {"frame_20121214T142255.814212", "frame_20121214T142256.068683", "frame_20121214T142256.332395"}) {
    const io::depth_frame depth = io::load_png(folder + name + "_depth.png");
    const io::cloud cloud = io::load_pcd(folder + name + ".pcd");
    REQUIRE(depth.pixels.size() == cloud.points.size());
    REQUIRE(depth.width == cloud.width);
    double worst = 0;
    std::size_t differ = 0;
    for (std::size_t i = 0; i < depth.pixels.size(); ++i) {
      const bool valid = cloud.points[i].allFinite();
      differ += valid != (depth.pixels[i] != 0);
      if (!valid) continue;
      const double z = 0.001 * depth.pixels[i], u = double(i % depth.width), v = double(i / depth.width);
      const Eigen::Vector3d p((u - 320) * z / 525, (v - 240) * z / 525, z);
      worst = std::max(worst, (p - cloud.points[i]).norm());
    }
    CHECK(differ == 0);
    CHECK(worst < 1e-6);
  }
}

}  // namespace depth_test
