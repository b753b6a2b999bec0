// SPDX-License-Identifier: BSD-3-Clause
#include "io/scratch_file.hpp"
#include "support/catch.hpp"

#include <clearance/io/cloud_file.hpp>
#include <clearance/io/ply_writer.hpp>
#include <clearance/io/scene.hpp>

#include <cstring>

namespace ply_writer_test {

using namespace clearance;

TEST_CASE("a PLY file that is written has the positions to the last bit, and a record for each point") {
  const std::vector<Eigen::Vector3d> points = {{447123.0625, 5411987.1, 1e-300}, {-0.1, 1.0 / 3, 3}, {0, -0.0, 1e18}};
  const io::ply_column columns[] = {{"red", std::vector<std::uint8_t>{0, 128, 255}},
                                    {"distance", std::vector<float>{0.25f, infinity, -1}},
                                    {"point", std::vector<std::uint32_t>{7, 4294967295u, 0}},
                                    {"part", std::vector<std::int32_t>{-1, 2, -2147483647}}};
  const scratch_file file(".ply");
  io::save_ply(file.path, points, columns, "made\nby a test");
  const io::cloud read = io::load_ply(file.path);
  CHECK(read.points == points);
  const std::string bytes = io::read_bytes(file.path);
  const std::string head =
      "ply\nformat binary_little_endian 1.0\ncomment made\\x0aby a test\nelement vertex 3\nproperty double x\nproperty "
      "double y\nproperty double z\n"
      "property uchar red\nproperty float distance\nproperty uint point\nproperty int part\nend_header\n";
  REQUIRE(bytes.starts_with(head));
  REQUIRE(bytes.size() == head.size() + 3 * (24 + 1 + 4 + 4 + 4));
  const char* second = bytes.data() + head.size() + 37 + 24;
  CHECK(std::uint8_t(second[0]) == 128);
  float distance;
  std::uint32_t point;
  std::int32_t part;
  std::memcpy(&distance, second + 1, 4), std::memcpy(&point, second + 5, 4), std::memcpy(&part, second + 9, 4);
  CHECK(distance == infinity);
  CHECK(point == 4294967295u);
  CHECK(part == 2);
  std::memcpy(&part, second + 37 + 9, 4);
  CHECK(part == -2147483647);

  io::save_ply(file.path, {}, {});  // takes the place of the other
  CHECK(io::load_ply(file.path).points.empty());
}

TEST_CASE("columns that do not fit their points, or have no name, are refused") {
  const std::vector<Eigen::Vector3d> points(3);
  const io::ply_column few[] = {{"distance", std::vector<float>{1, 2}}},
                       many[] = {{"distance", std::vector<float>{1, 2, 3, 4}}};
  CHECK_THROWS_WITH(io::ply_bytes(points, few), "clearance: the PLY column \"distance\" has 2 values for 3 points");
  CHECK_THROWS_AS(io::ply_bytes(points, many), std::invalid_argument);
  for (const std::string name : {"", "a b", "x\n", "\xc3\xb6"}) {
    const io::ply_column column[] = {{name, std::vector<float>(3, 0.0f)}};
    CHECK_THROWS_AS(io::ply_bytes(points, column), std::invalid_argument);
  }
  CHECK(refusal([&] { io::save_ply("/nonexistent/folder/x.ply", points, {}); }).find("/nonexistent/folder/x.ply") == 0);
}

TEST_CASE("a distance is red at 0 and inside, green half way, and blue where far begins") {
  const auto is = [](double distance, double far, float red, float green, float blue) {
    const io::colour c = io::distance_colour(distance, far);
    return c.red == red && c.green == green && c.blue == blue && c.alpha == 1;
  };
  CHECK(is(0, 2, 1, 0, 0));
  CHECK(is(-3, 2, 1, 0, 0));
  CHECK(is(0.5, 2, 1, 1, 0));
  CHECK(is(1, 2, 0, 1, 0));
  CHECK(is(1.5, 2, 0, 1, 1));
  CHECK(is(2, 2, 0, 0, 1));
  CHECK(is(infinity, 2, 0, 0, 1));
  CHECK(is(0.25, 2, 1, 0.5f, 0));
}

TEST_CASE("a PLY file in pieces is the same file, and pieces that are not its points are refused") {
  std::vector<Eigen::Vector3d> points;
  std::vector<float> values;
  for (int i = 0; i < 10; ++i) points.emplace_back(i, 0.1 * i, -i), values.push_back(float(i) / 3);
  const scratch_file file(".ply");
  const io::ply_column whole[] = {{"distance", values}};
  for (const std::size_t each : {1u, 3u, 10u}) {
    std::size_t at = 0;
    io::save_ply_pieces(
        file.path, points.size(),
        [&] {
          const std::size_t begin = std::exchange(at, std::min(points.size(), at + each));
          const auto some = [&](const auto& all) {
            return std::remove_cvref_t<decltype(all)>(all.begin() + std::ptrdiff_t(begin),
                                                      all.begin() + std::ptrdiff_t(at));
          };
          return io::ply_piece{some(points), {{"distance", some(values)}}};
        },
        "made");
    CHECK(io::read_bytes(file.path) == io::ply_bytes(points, whole, "made"));
  }
  io::save_ply_pieces(file.path, 0, [] { return io::ply_piece{{}, {{"distance", std::vector<float>{}}}}; });
  const std::string empty = io::read_bytes(file.path);
  CHECK(empty.find("element vertex 0\n") != empty.npos);
  CHECK(empty.find("property float distance\n") != empty.npos);
  CHECK_THROWS_AS(io::save_ply_pieces(file.path, 3, [&] { return io::ply_piece{points, {}}; }), std::invalid_argument);
  CHECK_THROWS_AS(io::save_ply_pieces(file.path, 3, [] { return io::ply_piece{}; }), std::invalid_argument);
  CHECK(io::read_bytes(file.path) == empty);  // whole or not at all
}

}  // namespace ply_writer_test
