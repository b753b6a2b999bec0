// SPDX-License-Identifier: BSD-3-Clause
#include "io/scratch_file.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

#include <clearance/io/cloud_file.hpp>

#include <liblzf/lzf.h>

#include <random>

namespace pcd_test {

using namespace clearance;

namespace {

std::string header(const std::string& fields, const std::string& size, const std::string& type,
                   const std::string& count, const std::string& rest) {
  return "# .PCD\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + size + "\nTYPE " + type + "\nCOUNT " + count + "\n" +
         rest;
}

std::string plain(const std::string& rest) { return header("x y z", "4 4 4", "F F F", "1 1 1", rest); }

io::cloud read(const std::string& bytes) {
  const scratch_file file(".pcd", bytes);
  return io::load_pcd(file.path);
}

std::string refused(const std::string& bytes) {
  return refusal([&] { read(bytes); });
}

bool says(const std::string& sentence, const std::string& part) {
  INFO("\"" << sentence << "\" should say \"" << part << "\"");
  CHECK(sentence.find(part) != std::string::npos);
  return sentence.find(part) != std::string::npos;
}

/// The same three records (1,2,3) (nan) (4,5,6) with a colour, in the three encodings.
std::string sample_file(const std::string& encoding) {
  const std::string head = header("rgb x y z", "4 4 4 4", "U F F F", "1 1 1 1",
                                  "WIDTH 3\nHEIGHT 1\nVIEWPOINT 1 2 3 0 1 0 0\nPOINTS 3\nDATA " + encoding + "\n");
  const float nan = not_a_number;
  if (encoding == "ascii") return head + "7 1 2 3\n8 nan nan nan\n9 4 5 6\n";
  if (encoding == "binary") return head + raw_bytes(7u, 1.f, 2.f, 3.f, 8u, nan, nan, nan, 9u, 4.f, 5.f, 6.f);
  const std::string by_field = raw_bytes(7u, 8u, 9u, 1.f, nan, 4.f, 2.f, nan, 5.f, 3.f, nan, 6.f);
  std::string packed(200, '\0');
  const unsigned size =
      lzf_compress(by_field.data(), unsigned(by_field.size()), packed.data(), unsigned(packed.size()));
  REQUIRE(size > 0);
  return head + raw_bytes(std::uint32_t(size), std::uint32_t(by_field.size())) + packed.substr(0, size) +
         std::string(3901, '\0');
}

}  // namespace

TEST_CASE("the three encodings of a PCD file give the same records, invalid ones in their place") {
  for (const std::string encoding : {"ascii", "binary", "binary_compressed"}) {
    const io::cloud c = read(sample_file(encoding));
    REQUIRE(c.points.size() == 3);
    CHECK(c.points[0] == Eigen::Vector3d(1, 2, 3));
    CHECK(!c.points[1].allFinite());
    CHECK(c.points[2] == Eigen::Vector3d(4, 5, 6));
    CHECK(c.width == 3);
    REQUIRE(c.viewpoint);
    CHECK(c.viewpoint->translation == Eigen::Vector3d(1, 2, 3));
    CHECK(c.viewpoint->rotation.x() == 1);  // PCD puts w first
  }
}

TEST_CASE("whole numbers of a PCD file keep sign and digits, in every type and size") {
  const auto check = []<class T>(T, const std::string& type) {
    constexpr T least = std::numeric_limits<T>::min(), most = std::numeric_limits<T>::max();
    const std::string size = std::to_string(sizeof(T)), sizes = size + ' ' + size + ' ' + size;
    const io::cloud c = read(
        header("x y z", sizes, type + ' ' + type + ' ' + type, "1 1 1", "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary\n") +
        raw_bytes(least, most, T(1), T(100), T(most - 1), T(least + 1)));
    REQUIRE(c.points.size() == 2);
    CHECK(c.points[0] == Eigen::Vector3d(double(least), double(most), 1));
    CHECK(c.points[1] == Eigen::Vector3d(100, double(T(most - 1)), double(T(least + 1))));
  };
  check(std::int8_t(), "I"), check(std::int16_t(), "I"), check(std::int32_t(), "I"), check(std::int64_t(), "I");
  check(std::uint8_t(), "U"), check(std::uint16_t(), "U"), check(std::uint32_t(), "U"), check(std::uint64_t(), "U");
}

TEST_CASE("fields may have any order and type, and counts above one") {
  const std::string bytes =
      header("z _ y n x", "2 1 8 4 1", "I U F F U", "1 3 1 2 1", "WIDTH 1\nHEIGHT 2\nPOINTS 2\nDATA binary\n");
  const auto record = [](std::int16_t z, double y, std::uint8_t x) {
    return raw_bytes(z) + "___" + raw_bytes(y, 1.f, 2.f, x);
  };
  const io::cloud c = read(bytes + record(-3, 2.5, 200) + record(4, -1, 0));
  REQUIRE(c.points.size() == 2);
  CHECK(c.points[0] == Eigen::Vector3d(200, 2.5, -3));
  CHECK(c.points[1] == Eigen::Vector3d(0, -1, 4));
  CHECK(c.height == 2);
  const io::cloud text = read(header("z _ y", "4 1 4", "F U F", "1 3 1", "").substr(0, 0) +
                              "VERSION .5\r\nCOLUMNS z _ y x\r\nSIZE 4 1 4 4\r\nTYPE F U F F\r\nCOUNT 1 2 1 1\r\nWIDTH "
                              "1\r\nDATA ascii\r\n3 0 0 2 1\r\n");
  REQUIRE(text.points.size() == 1);
  CHECK(text.points[0] == Eigen::Vector3d(1, 2, 3));
}

TEST_CASE("a field of COUNT 0 takes no bytes: drivers of lidars write it for padding") {
  for (const std::string data : {"binary", "ascii"}) {
    const std::string rest = "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA " + data + "\n";
    const std::string head = header("x _ y z", "4 1 4 4", "F U F F", "1 0 1 1", rest);
    const io::cloud c = read(head + (data == "ascii" ? "1 2 3\n4 5 6\n" : raw_bytes(1.f, 2.f, 3.f, 4.f, 5.f, 6.f)));
    REQUIRE(c.points.size() == 2);
    CHECK(c.points[1] == Eigen::Vector3d(4, 5, 6));
    says(refused(header("x y z", "4 4 4", "F F F", "1 0 1", rest) + "1 3\n4 6\n"), "field y must have COUNT 1");
  }
}

TEST_CASE("coordinates far from 0 keep the precision of the file") {
  const std::string head = header("x y z", "8 8 8", "F F F", "1 1 1", "WIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA ");
  const double x = 447123.0625, y = 5411987.001;
  for (const auto& bytes : {head + "binary\n" + raw_bytes(x, y, 250.5, x + 0.001, y, 250.25, 0.0, 0.0, 0.0),
                            head + "ascii\n447123.0625 5411987.001 250.5\n447123.0635 5411987.001 250.25\n0 0 0\n"}) {
    const io::cloud c = read(bytes);
    REQUIRE(c.points.size() == 3);
    CHECK(c.points[0] == Eigen::Vector3d(x, y, 250.5));
    CHECK((c.points[1] - Eigen::Vector3d(x + 0.001, y, 250.25)).norm() < 1e-9);
    CHECK(c.points[2].isZero(0));  // "no return" must stay recognisable
  }
}

TEST_CASE("an empty PCD cloud is a cloud, an empty file is an error") {
  CHECK(read(plain("WIDTH 0\nHEIGHT 1\nPOINTS 0\nDATA ascii\n")).points.empty());
  CHECK(read(plain("WIDTH 0\nHEIGHT 1\nPOINTS 0\nDATA binary\n")).points.empty());
  CHECK(read(plain("WIDTH 0\nHEIGHT 1\nPOINTS 0\nDATA binary_compressed\n")).points.empty());
  says(refused(""), "is empty (0 bytes)");
  says(refusal([] { io::load_pcd("/nonexistent/cloud.pcd"); }), "/nonexistent/cloud.pcd: there is no such file");
}

TEST_CASE("a PCD file that contradicts itself is refused with its line or its numbers") {
  says(refused("hello\n"), "\"hello\" is no PCD header entry");
  says(refused(plain("WIDTH 2\nHEIGHT 2\nPOINTS 3\nDATA ascii\n")), "WIDTH 2 times HEIGHT 2 is not POINTS 3");
  says(refused(plain("WIDTH 2\nPOINTS 2\nDATA ascii\n1 2 3\n")), "ends after 1 records");
  says(refused(plain("WIDTH 1\nPOINTS 1\nDATA ascii\n1 2 3\n4 5 6\n")),
       ":11: POINTS says 1, but here is another record");
  says(refused(plain("WIDTH 1\nPOINTS 1\nDATA ascii\n1 2\n")), ":10: a record needs 3 values, here are 2");
  says(refused(plain("WIDTH 1\nPOINTS 1\nDATA ascii\n1 2 3m\n")), ":10: \"3m\" is not a number");
  says(refused(plain("WIDTH -1\nDATA ascii\n")), ":7: WIDTH \"-1\" is not a whole number in range");
  says(refused(header("x y", "4 4", "F F", "1 1", "WIDTH 0\nDATA ascii\n")), "no field z");
  says(refused(header("x y z x", "4 4 4 4", "F F F F", "1 1 1 1", "WIDTH 0\nDATA ascii\n")), "more than one field x");
  says(refused(header("x y z", "4 4", "F F F", "1 1 1", "")), ":4: SIZE has 2 entries for 3 fields");
  says(refused(header("x y z", "4 4 3", "F F F", "1 1 1", "")), "SIZE 3 is not 1, 2, 4 or 8");
  says(refused(header("x y z", "4 4 2", "F F F", "1 1 1", "WIDTH 0\nDATA ascii\n")), "float of 2 bytes");
  says(refused(header("x y z", "4 4 4", "F F G", "1 1 1", "")), "TYPE \"G\" is not F, I or U");
  says(refused(plain("WIDTH 1\nPOINTS 1\n")), "no DATA entry");
  says(refused(plain("WIDTH 1\nDATA zip\n")), "DATA \"zip\"");
  says(refused("VERSION 0.8\n"), "version");
}

TEST_CASE("no number in a PCD file is believed before it is compared with the file's size") {
  const std::string most = "4294967295";
  for (const std::string encoding : {"ascii", "binary", "binary_compressed"}) {
    CHECK(!refused(plain("WIDTH " + most + "\nHEIGHT 1\nPOINTS " + most + "\nDATA " + encoding + "\n")).empty());
    CHECK(!refused(plain("WIDTH " + most + "\nHEIGHT " + most + "\nDATA " + encoding + "\n12345678")).empty());
    CHECK(!refused(header("x y z _", "4 4 4 8", "F F F F", "1 1 1 " + most, "WIDTH 1\nDATA " + encoding + "\n1 2 3\n"))
               .empty());
    CHECK(!refused(plain("WIDTH 99999999999999999999\nDATA " + encoding + "\n")).empty());
  }
  const std::string head = plain("WIDTH 100000000\nHEIGHT 1\nPOINTS 100000000\nDATA binary_compressed\n");
  says(refused(head + raw_bytes(16u, 1200000000u) + std::string(16, 'x')), "which is impossible");
  says(refused(head + raw_bytes(17u, 1200000000u) + std::string(16, 'x')), "cut short");
  says(refused(plain("WIDTH 2\nDATA binary_compressed\n") + raw_bytes(16u, 24u) + std::string(16, '\xff')), "damaged");
}

TEST_CASE("a PCD file cut at any length or with any byte changed is read or refused, never more") {
  for (const std::string encoding : {"ascii", "binary", "binary_compressed"}) {
    const std::string whole = sample_file(encoding).substr(0, 330);
    const std::size_t enough = io::read_pcd(whole, "fuzz").points.size() == 3 ? whole.find("DATA") + 10 : 0;
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const std::string why = refusal([&] { io::read_pcd(whole.substr(0, length), "fuzz"); });
      if (length < enough) CHECK(!why.empty());
    }
    std::mt19937 random(7);
    int accepted = 0;
    std::size_t most = 0;
    for (int i = 0; i < 2000; ++i) {
      std::string changed = whole;
      for (int k = 0; k <= i % 3; ++k) changed[random() % changed.size()] = char(random());
      accepted += refusal([&] { most = std::max(most, io::read_pcd(changed, "fuzz").points.size()); }).empty();
    }
    CHECK(most <= whole.size());
    CHECK(accepted > 20);
    CHECK(accepted < 1980);
  }
}

TEST_CASE("every real PCD file is read, with the number of invalid points that its source states", "[data]") {
  const std::string folder = testing::data("/clouds/");
  if (!std::filesystem::exists(folder)) {
    WARN("SKIPPED: no folder " << folder);
    return;
  }
  struct expected {
    const char* file;
    std::size_t width, height, invalid;
  };
  for (const auto& [name, width, height, invalid] :
       {expected{"kinect_seq/frame_20121214T142255.814212.pcd", 640, 480, 35625},
        expected{"lidar/251370668.pcd", 69088, 1, 0}, expected{"lidar/room_scan1.pcd", 112586, 1, 0},
        expected{"organized/capture0001.pcd", 640, 480, 57553}, expected{"organized/five_people.pcd", 640, 480, 68125},
        expected{"organized/table_scene_mug_stereo_textured.pcd", 640, 480, 97920},
        expected{"small/bunny.pcd", 397, 1, 0}, expected{"small/car6.pcd", 10031, 1, 0},
        expected{"small/colored_cloud.pcd", 1, 1000, 0}, expected{"small/curve_close.pcd", 110, 1, 0},
        expected{"small/krylon.pcd", 4467, 1, 0}, expected{"small/lamppost.pcd", 1771, 1, 0},
        expected{"small/milk_color.pcd", 13704, 1, 0}, expected{"small/object_template_0.pcd", 1397, 1, 0},
        expected{"small/octants.pcd", 8, 1, 0}, expected{"unorganized/region_growing_tutorial_mm.pcd", 108104, 1, 0}}) {
    INFO(name);
    const io::cloud c = io::load_pcd(folder + name);
    CHECK(c.width == width);
    CHECK(c.height == height);
    CHECK(c.points.size() == width * height);
    CHECK(std::size_t(std::count_if(c.points.begin(), c.points.end(), [](const auto& p) { return !p.allFinite(); })) ==
          invalid);
  }
  const io::cloud octants = io::load_pcd(folder + "small/octants.pcd");
  CHECK(std::abs(octants.points.front().z()) <= 9);
}

TEST_CASE(
    "PCD fields in capitals, a mark before the header, and a page that is filled and then ends a line are a PCD file") {
  const auto points = read(plain("WIDTH 2\nPOINTS 2\nDATA ascii\n1 2 3\n4 5 6\n")).points;
  CHECK(read(header("X Y Z", "4 4 4", "F F F", "1 1 1", "WIDTH 2\nPOINTS 2\nDATA ascii\n1 2 3\n4 5 6\n")).points ==
        points);
  CHECK(read("\xEF\xBB\xBF" + plain("WIDTH 2\nPOINTS 2\nDATA ascii\n1 2 3\n4 5 6\n")).points == points);
  says(refused(header("x y z X", "4 4 4 4", "F F F F", "1 1 1 1", "WIDTH 0\nDATA ascii\n")), "more than one field x");
  for (const std::string encoding : {"binary", "binary_compressed"}) {
    const std::string whole = sample_file(encoding), file = whole.substr(0, whole.find_last_not_of('\0') + 1);
    const std::string zeros(encoding == "binary" ? 3000 : 3901, '\0');
    for (const std::string& end :
         {std::string("\n"), std::string("\r\n"), zeros, zeros + "\n", zeros + "\r\n", "\n" + zeros, "\r\n" + zeros}) {
      INFO(encoding << ' ' << end.size());
      CHECK(read(file + end).points.size() == 3);
    }
    for (const std::string& end : {"\n" + zeros + "\n", zeros + "\n" + zeros, zeros + "\n\n", zeros + "x",
                                   std::string("\n\n"), std::string(4096, '\0'), std::string(4096, '\0') + "\n"})
      says(refused(file + end), "bytes follow the last record");
    if (encoding != "binary") continue;
    // The header's lines end with \r, but the last one with \r\n: there is one byte more than the records need.
    std::string returns = file;
    const std::size_t after = returns.find('\n', returns.find("DATA"));
    std::replace(returns.begin(), returns.begin() + std::ptrdiff_t(after), '\n', '\r');
    returns.insert(after, 1, '\r');
    says(refused(returns), "unclear where the data begin");
  }
}

}  // namespace pcd_test
