// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Reads the file that `clearance query --distances` writes.

#include "support/catch.hpp"

#include <clearance/io/cloud_file.hpp>

#include <cstring>
#include <fstream>
#include <string>
#include <vector>

namespace testing {

struct distance_record {
  double x, y, z;
  int red, green, blue;
  float distance;
  std::uint32_t cloud, point;
  std::int32_t part;
};

inline std::vector<distance_record> records(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(in), {});
  const std::string end = "end_header\n";
  const std::size_t at = bytes.find(end);
  REQUIRE(at != bytes.npos);
  const std::string head = bytes.substr(0, at);
  CHECK(head.starts_with("ply\nformat binary_little_endian 1.0\n"));
  CHECK(head.find("property double x\nproperty double y\nproperty double z\nproperty uchar red\nproperty uchar "
                  "green\nproperty uchar blue\n"
                  "property float distance\nproperty uint cloud\nproperty uint point\nproperty int part\n") !=
        head.npos);
  std::vector<distance_record> all;
  constexpr std::size_t size = 24 + 3 + 4 * 4;
  REQUIRE((bytes.size() - at - end.size()) % size == 0);
  for (const char* from = bytes.data() + at + end.size(); from < bytes.data() + bytes.size(); from += size) {
    distance_record r{};
    std::memcpy(&r.x, from, 8), std::memcpy(&r.y, from + 8, 8), std::memcpy(&r.z, from + 16, 8);
    r.red = std::uint8_t(from[24]), r.green = std::uint8_t(from[25]), r.blue = std::uint8_t(from[26]);
    std::memcpy(&r.distance, from + 27, 4), std::memcpy(&r.cloud, from + 31, 4), std::memcpy(&r.point, from + 35, 4),
        std::memcpy(&r.part, from + 39, 4);
    all.push_back(r);
  }
  CHECK(clearance::io::load_ply(file).points.size() == all.size());
  return all;
}

}  // namespace testing
