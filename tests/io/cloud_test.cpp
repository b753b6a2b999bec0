// SPDX-License-Identifier: BSD-3-Clause
#include "io/scratch_file.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

#include <clearance/io/cloud_file.hpp>

#include <random>

namespace cloud_test {

using namespace clearance;

namespace {

std::string refused(const std::string& end, const std::string& bytes) {
  const scratch_file file(end, bytes);
  return refusal([&] { io::load_cloud(file.path); });
}

bool contains(const std::string& sentence, const std::string& part) {
  INFO("\"" << sentence << "\" should say \"" << part << "\"");
  CHECK(sentence.find(part) != std::string::npos);
  return true;
}

io::cloud read(const std::string& end, const std::string& bytes) {
  const scratch_file file(end, bytes);
  return io::load_cloud(file.path);
}

std::string ply(const std::string& format, const std::string& count, const std::string& type, const std::string& rest) {
  return "ply\nformat " + format + " 1.0\ncomment ours\nelement vertex " + count + "\nproperty " + type +
         " z\nproperty uchar red\nproperty " + type + " x\nproperty " + type +
         " y\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n" + rest;
}

std::string record(float x, float y, float z) {
  std::string bytes(13, '\xC8');
  std::memcpy(bytes.data(), &z, 4);
  std::memcpy(bytes.data() + 5, &x, 4);
  std::memcpy(bytes.data() + 9, &y, 4);
  return bytes;
}

}  // namespace

TEST_CASE("an XYZ file may have comments, other separators and further columns") {
  const io::cloud c =
      read(".xyz",
           "\xEF\xBB\xBF# made by hand\n1 2 3 red\r\n\n  4,5,6, 255\n7;8\t9 0 # last\nnan nan nan -\n+1e1 -.5 inf x");
  REQUIRE(c.points.size() == 5);
  CHECK(c.points[0] == Eigen::Vector3d(1, 2, 3));
  CHECK(c.points[1] == Eigen::Vector3d(4, 5, 6));
  CHECK(c.points[2] == Eigen::Vector3d(7, 8, 9));
  CHECK(!c.points[3].allFinite());
  CHECK(c.points[4].x() == 10);
  CHECK(c.points[4].z() == infinity);
  CHECK(c.width == 5);
  CHECK(c.height == 1);
}

TEST_CASE("an XYZ file is refused with the number of its line") {
  contains(refused(".xyz", "1 2 3\n# fine\n1 2\n"), ":3: a point needs three numbers, here are 2");
  contains(refused(".xyz", "x y z\n1 2 3\n"), ":1: \"x\" is not a number");
  contains(refused(".xyz", "1 2 +-3\n"), ":1: \"+-3\" is not a number");
  for (const std::string columns : {"", " 4", " 4 5 6", " a b"})  // two lines that became one, whatever their columns
    contains(refused(".xyz", "1 2 3" + columns + "\n\n4 5 6" + columns + " 7 8 9" + columns + "\n"), ":3: a point of ");
  contains(refused(".xyz", ""), "is empty (0 bytes)");
  CHECK(read(".xyz", "# nothing\n\n").points.empty());
  for (const char* end : {".las", ".LAZ", ".copc.laz"}) {
    contains(refused(end, "LASF"), "is no point cloud by its name");
    contains(refused(end, "LASF"), "LAS and LAZ by the Python package");
  }
}

TEST_CASE("floats for a query are exact where floats can be, and say what they lost where not") {
  std::mt19937 random(3);
  for (const double away : {0.0, 5.0, 70.0, 1e4, 5e6}) {
    std::uniform_real_distribution<float> along(float(away) - 5, float(away) + 5);
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 500; ++i)
      points.emplace_back(double(along(random)), double(along(random)), double(along(random)));
    const io::cloud c = io::make_cloud("", points, points.size(), 1);
    Eigen::Isometry3d robot = Eigen::Isometry3d::Identity();
    robot.translation().setConstant(away);
    const io::float_cloud near = c.near(std::vector{robot});
    CHECK(near.origin.isZero(0) == (away <= 32));
    CHECK(near.pose.translation() == near.origin);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const vec3 f = near.points[i];
      const Eigen::Vector3d p(f.x, f.y, f.z);
      CHECK((near.origin + p - points[i]).norm() <= near.off.absolute + near.off.relative * p.norm());
      if (away > 5) CHECK((near.off.relative == 0 && near.origin + p == points[i]));
    }
    const io::float_cloud far = c.relative_to({-5e6, 1, 0});
    CHECK(far.off.relative > 0);
    CHECK(far.off.absolute > 0);
  }
  CHECK(io::make_cloud("", {{0.5, 0.25, 3}}, 1, 1).relative_to({0, 0, 0}).off.relative == 0);
  CHECK(io::make_cloud("", {{0.1, 0.25, 3}}, 1, 1).relative_to({0, 0, 0}).off.relative > 0);
}

TEST_CASE("many configurations of a robot that stands far away have the floats that each has alone") {
  const io::cloud c = io::make_cloud("", {{4e6, 5e5, 0.1}, {4e6 + 0.3, 5e5, 0.7}}, 2, 1);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> off(-2, 2);
  Eigen::Isometry3d camera = Eigen::Isometry3d::Identity();
  camera.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  std::vector<std::vector<Eigen::Isometry3d>> each(20);
  std::vector<Eigen::Isometry3d> all;
  for (auto& poses : each) {
    poses.assign(3, camera * Eigen::Translation3d(4e6, 5e5, 0));
    for (std::size_t k = 1; k < 3; ++k)
      poses[k] = poses[k] * Eigen::Translation3d(off(random), off(random), off(random));
    all.insert(all.end(), poses.begin(), poses.end());
  }
  const io::float_cloud together = c.near(all, camera);
  CHECK(!together.origin.isZero(0));
  for (const auto& poses : each) {
    const io::float_cloud alone = c.near(poses, camera);
    CHECK((alone.origin == together.origin && alone.points == together.points));
  }
}

TEST_CASE("the points of a PLY file come in the file's order, from text and from bytes") {
  const std::string text = ply("ascii", "3", "float", "3 200 1 2\nnan 200 nan nan\n6 200 4 5\n");
  const std::string bytes =
      ply("binary_little_endian", "3", "float", record(1, 2, 3) + record(not_a_number, 0, 0) + record(4, 5, 6));
  for (const io::cloud& c : {read(".ply", text), read(".PLY", bytes)}) {
    REQUIRE(c.points.size() == 3);
    CHECK(c.points[0] == Eigen::Vector3d(1, 2, 3));
    CHECK(!c.points[1].allFinite());
    CHECK(c.points[2] == Eigen::Vector3d(4, 5, 6));
  }
  // Data that begin with what looks like the end of a line.
  for (const std::string begin : {"\n", "\r\n", "\n\n", "\r", " "}) {
    std::string first = record(1, 2, 3);
    first.replace(0, begin.size(), begin);
    float z;
    std::memcpy(&z, first.data(), 4);
    const io::cloud c = read(".ply", ply("binary_little_endian", "2", "float", first + record(4, 5, 6)));
    CHECK(c.points[0] == Eigen::Vector3d(1, 2, z));
    CHECK(c.points[1] == Eigen::Vector3d(4, 5, 6));
  }
}

TEST_CASE("a PLY file that is not what it says is refused") {
  CHECK(read(".ply", ply("ascii", "0", "float", "")).points.empty());
  contains(refused(".ply", ""), "is empty (0 bytes)");
  contains(refused(".ply", "plx\n"), "is not a PLY file");
  contains(refused(".ply", ply("ascii", "353535235358", "float", "3 200 1 2\n")), "more than the file holds");
  contains(refused(".ply", ply("binary_little_endian", "2", "float", record(1, 2, 3))), "more than the file holds");
  contains(refused(".ply", ply("ascii", "2", "float", "3.0000 200 1.00000 2.00000\n")), "the file ends after 1");
  contains(refused(".ply", ply("ascii", "1", "float", "3 200 1 two\n")), ":12: \"two\" is not a number");
  contains(refused(".ply", ply("ascii", "1", "float", "3 200 1\n\n\n")),
           ":12: vertex 0 has fewer values than the header says");
  contains(refused(".ply", ply("ascii", "1", "real", "")), ":5: a PLY property needs");
  CHECK(read(".ply", ply("ascii", "1", "double", "1 200 5000000.125 2\n")).points.at(0).x() == 5000000.125);
  CHECK(read(".ply", ply("ascii", "1", "double", "1 200 5.125 2\n")).points.at(0) == Eigen::Vector3d(5.125, 2, 1));
}

TEST_CASE("a PLY file cut at any length or with any byte changed is read or refused, never more") {
  for (const std::string& whole : {ply("ascii", "2", "float", "3 200 1 2\n6 200 4 5\n"),
                                   ply("binary_big_endian", "2", "float", record(1, 2, 3) + record(4, 5, 6))}) {
    for (std::size_t length = 0; length < whole.size() - 1; ++length) {
      const std::string why = refusal([&] { io::read_ply(whole.substr(0, length), "fuzz"); });
      if (whole.size() - length > 2) CHECK(!why.empty());  // without the last digit or line end, text is still whole
    }
    std::mt19937 random(5);
    std::size_t most = 0;
    for (int i = 0; i < 1500; ++i) {
      std::string changed = whole;
      for (int k = 0; k <= i % 3; ++k) changed[random() % changed.size()] = char(random());
      refusal([&] { most = std::max(most, io::read_ply(changed, "fuzz").points.size()); });
    }
    CHECK(most <= whole.size());
  }
}

TEST_CASE("real damaged PLY files are read or refused", "[data]") {
  const std::string folder = testing::data("/malformed/");
  if (!std::filesystem::exists(folder)) {
    WARN("SKIPPED: no folder " << folder);
    return;
  }
  int read = 0, refused = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (io::extension(entry.path().string()) != ".ply") continue;
    INFO(entry.path());
    const std::string why = refusal([&] { io::load_ply(entry.path().string()); });
    ++(why.empty() ? read : refused);
    CHECK((why.empty() || why.find(entry.path().string()) == 0));
  }
  CHECK(read == 19);
  CHECK(refused == 5);  // counts too low, lines with too many values
  CHECK(io::load_ply(folder + "trimesh/points_emptyface.ply").points.size() == 1024);
  CHECK(io::load_ply(folder + "trimesh/empty.ply").points.empty());
}

TEST_CASE(
    "decimal commas, thousands and empty coordinates of a text cloud are refused with the line, separators are not") {
  for (const char* line :
       {"0,5 0,2 0,1", "0,5;0,2;0,1", "0,5\t0,2\t0,1", "0,5, 0,2, 0,1", "0,5; 0,2; 0,1", "-0,5 0 1", "0 0,2 1",
        "0 1 0,2", "1,5e3 2 3", "1,234.5 2,345.6 3,456.7", "1.234,5 2.345,6 3.456,7", "500,000 5,000,000.0 3",
        "1,000;2,000;3,000", "1,5 2,5 3,5 255", "0,5;0,2;0,1;7", "0,5 0,2"}) {
    INFO(line);
    contains(refused(".xyz", "1 2 3\n" + std::string(line) + "\n"), ":2: \"");
    contains(refused(".txt", std::string(line) + " # one\n"), "may be one number or several");
  }
  for (const char* line : {",1,2,3", "1,,2,3", "1,2,,3", "1;;2;3", ";1;2;3", "1; ;2;3", "1;2; ;3", "1 , , 2 3"})
    contains(refused(".xyz", std::string(line) + "\n"), ":1: nothing stands for ");
  for (const char* line :
       {"1,2,3",     "1, 2, 3",      "1 ,2 ,3",      "1 , 2 , 3", "1;2;3",          "1; 2; 3",   "1\t2\t3",
        "1 2 3",     "1,2,3,",       "1,2,3 4",      "1,2,3;4",   "1,2,3,,4",       "1,2,3, ,4", "1 2 3 a,b",
        "1,2,3,4,5", "1.0,2.0, 3.0", "1.0, 2.0,3.0", "1;2;3;0,5", "//X Y Z\n1 2 3", " 1 2 3 ",   "1 2 3;"}) {
    INFO(line);
    const io::cloud c = read(".xyz", std::string(line) + "\n");
    REQUIRE(c.points.size() == 1);
    CHECK(c.points[0] == Eigen::Vector3d(1, 2, 3));
  }
  contains(refused(".xyz", "1,2,3,4\n1,2,3,\n"), ":2: a point of 3 words");
}

}  // namespace cloud_test
