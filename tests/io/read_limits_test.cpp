// SPDX-License-Identifier: BSD-3-Clause
// How large a small compressed file may become.
#include "io/scratch_file.hpp"
#include "support/catch.hpp"
#include "tools/small_png.hpp"

#include <clearance/io/cloud_file.hpp>
#include <clearance/io/png.hpp>

#include <liblzf/lzf.h>

namespace read_limits_test {

using namespace clearance;

namespace {

/// A compressed PCD file of `points` records of three bytes that are all 0.
std::string packed_pcd(std::uint32_t points) {
  const std::string zeros(3 * std::size_t(points), '\0');
  std::string packed(zeros.size() + 100, '\0');
  packed.resize(lzf_compress(zeros.data(), unsigned(zeros.size()), packed.data(), unsigned(packed.size())));
  const auto raw = [](std::uint32_t v) { return std::string(reinterpret_cast<const char*>(&v), 4); };
  return "FIELDS x y z\nSIZE 1 1 1\nTYPE U U U\nWIDTH " + std::to_string(points) +
         "\nHEIGHT 1\nDATA binary_compressed\n" + raw(std::uint32_t(packed.size())) + raw(std::uint32_t(zeros.size())) +
         packed;
}

}  // namespace

TEST_CASE("a compressed cloud is read up to the limit that is set, and refused beyond with both sizes") {
  for (const std::uint32_t points : {1000u, 100000u, 1000000u}) {
    const std::string bytes = packed_pcd(points);
    const std::uint64_t memory = points * (3 + sizeof(Eigen::Vector3d) + sizeof(vec3));
    CHECK(io::read_pcd(bytes, "made.pcd", {.unfolded = memory}).points.size() == points);
    const std::string said = refusal([&] { io::read_pcd(bytes, "made.pcd", {.unfolded = memory - 1}); });
    INFO(said);
    CHECK(said.find("made.pcd: ") == 0);
    CHECK(said.find("more than the limit of " + std::to_string((memory - 1) >> 20) + " MiB (read_limits::unfolded)") !=
          std::string::npos);
  }
  // 5 MB that would become 15 GB of points are refused before anything is unpacked.
  std::string bomb = "FIELDS x y z\nSIZE 1 1 1\nTYPE U U U\nWIDTH 140000000\nHEIGHT 1\nDATA binary_compressed\n";
  for (const std::uint32_t size : {5000000u, 420000000u}) bomb.append(reinterpret_cast<const char*>(&size), 4);
  bomb += std::string(5000000, '\x41');
  CHECK(refusal([&] { io::read_pcd(bomb, "made.pcd"); }).find("limit of 1024 MiB") != std::string::npos);
  const std::string plain =
      "FIELDS x y z\nSIZE 1 1 1\nTYPE U U U\nWIDTH 1000\nHEIGHT 1\nDATA binary\n" + std::string(3000, '\1');
  CHECK(io::read_pcd(plain, "made.pcd", {.unfolded = 0}).points.size() == 1000);  // nothing unfolds
}

TEST_CASE("an image is read up to the limit that is set") {
  const std::string bytes = png(1000, 2000);
  CHECK(io::read_png(bytes, "made.png", {.unfolded = 8}).pixels.size() == 2);
  CHECK(refusal([&] { io::read_png(bytes, "made.png", {.unfolded = 7}); }).find("2x1 pixels") != std::string::npos);
  // A header of 16384 x 32767 pixels with enough data to be possible, of which nothing is unpacked.
  const std::string size("\0\0\x40\0\0\0\x7f\xff", 8);
  const std::string bomb = "\x89PNG\r\n\x1a\n" + chunk("IHDR", size + std::string("\x10\0\0\0\0", 5)) +
                           chunk("IDAT", std::string(1100000, 'x')) + chunk("IEND", "");
  const std::string said = refusal([&] { io::read_png(bomb, "made.png"); });
  INFO(said);
  CHECK(said.find("more than the limit of 1024 MiB (read_limits::unfolded)") != std::string::npos);
}

TEST_CASE("a pipe is read until it ends or is too much, and a device is not read") {
  const scratch_file file("");
  std::filesystem::remove(file.path);
  REQUIRE(::mkfifo(file.path.c_str(), 0600) == 0);
  const auto piped = [&](std::size_t size, std::uint64_t limit) {
    FILE* writer = ::popen(("head -c " + std::to_string(size) + " /dev/zero 2>/dev/null >" + file.path).c_str(), "r");
    std::string read;
    const std::string said = refusal([&] { read = io::read_bytes(file.path, {.piped = limit}); });
    ::pclose(writer);
    return said.empty() ? std::to_string(read.size()) : said;
  };
  CHECK(piped(300000, 300000) == "300000");
  CHECK(piped(300000, 200000).find("the limit for what is no regular file") != std::string::npos);
  for (const char* device : {"/dev/zero", "/dev/null"})
    CHECK(refusal([&] { io::read_bytes(device); }) == std::string(device) + ": is a device, not a file");
}

}  // namespace read_limits_test
