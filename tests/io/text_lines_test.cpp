// SPDX-License-Identifier: BSD-3-Clause
// Every text format with every line end, from the same lines: the content and the line in an error are the same.
#include "io/scratch_file.hpp"
#include "support/catch.hpp"

#include <clearance/io/cloud_file.hpp>
#include <clearance/io/cloud_text.hpp>
#include <clearance/io/spheres_file.hpp>
#include "io/mesh_formats.hpp"

#include <random>

namespace text_lines_test {

using namespace clearance;

namespace {

std::string with_ends(std::string text, const std::string& end) {
  for (std::size_t at = 0; (at = text.find('\n', at)) != text.npos; at += end.size()) text.replace(at, 1, end);
  return text;
}

const char* const ends[] = {"\n", "\r\n", "\r"};

std::string read_all(const std::string& ending, const std::string& bytes) {
  const scratch_file file(ending, bytes);
  std::string seen;
  const auto put = [&](double v) { seen += std::to_string(v) + ' '; };
  try {
    if (ending == ".obj" || ending == ".off") {
      const auto mesh = ending == ".obj" ? io::read_obj(bytes, file.path) : io::read_off(bytes, file.path);
      for (const auto& v : mesh.vertices)
        for (int k = 0; k < 3; ++k) put(v[k]);
      for (const auto c : mesh.corners) put(c);
    } else if (ending == ".csv" || ending == ".yaml") {
      for (const auto& part : io::load_spheres(file.path))
        for (const auto& s : part.spheres.spheres) put(s.center.x), put(s.center.y), put(s.center.z), put(s.radius);
    } else {
      for (const Eigen::Vector3d& p : io::load_cloud(file.path).points) put(p.x()), put(p.y()), put(p.z());
    }
  } catch (const std::runtime_error& error) {
    return std::string(error.what()).substr(file.path.size());
  }
  return seen;
}

}  // namespace

TEST_CASE("lines may end by \\n, \\r\\n or \\r alone in every text format") {
  const std::string pcd = "# .PCD v.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 3\nHEIGHT 1\nDATA ascii\n";
  const std::pair<std::string, std::string> files[] = {
      {".xyz", "# made\n1 2 3\n\n4 5 6 # here\n7,8,9"},
      {".txt", "1 2 3\n4 5 6\n7 8 9\n"},
      {".xyz", "1 2 3\n4 5\n"},
      {".pcd", pcd + "1 2 3\n4 5 6\n7 8 9\n"},
      {".pcd", pcd + "1 2 3\n4 5 6\n7 8 9"},
      {".pcd", pcd + "1 2 3\n4 5 6\n7 8 9\n1 1 1\n"},
      {".pcd", pcd + "1 2 3\n4 5 6\n"},
      {".ply",
       "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 "
       "3\n4 5 6\n"},
      {".obj", "# made\nv 1 2 3\nv 4 5 6\nv 0 0 0\nf 1 2 \\\n3\n"},
      {".obj", "v 1 2 3\nv 4 5 6\nf 1 2 3\n"},
      {".off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {".off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\n3 2 1 0\n"},
      {".csv", "x,y,z,r\n1,2,3,4\n5,6,7,8\n"},
      {".csv", "x,y,z,r\n1,2,3,4\n5,6,7\n"},
      {".yaml", "collision_spheres:\n  a:\n    - center: [1, 2, 3]\n      radius: 4\n"},
  };
  for (const auto& [ending, text] : files) {
    const std::string expected = read_all(ending, text);
    for (const char* end : ends) {
      INFO(ending << ' ' << text << " by " << int(end[0]));
      CHECK(read_all(ending, with_ends(text, end)) == expected);
    }
  }
}

TEST_CASE("lines that end in any mixture are the lines that were written") {
  std::mt19937 random(7);
  for (int round = 0; round < 300; ++round) {
    std::string text, again;
    for (int i = 0; i < 20; ++i) text += std::string(random() % 3, 'a') + ends[random() % 3];
    for (std::string_view rest = text; !rest.empty();) again += std::string(io::take_line(rest)) + '\n';
    std::string plain = text;
    for (std::size_t at = 0; (at = plain.find("\r\n", at)) != plain.npos; ++at) plain.erase(at, 1);
    for (char& c : plain) c = c == '\r' ? '\n' : c;
    CHECK(again == plain);
  }
}

TEST_CASE("a number with a # in it, as old runtimes spell NaN, is no number that a comment follows") {
  const std::pair<std::string, std::vector<std::string>> files[] = {
      {".xyz", {"", "7", " ", "8", " ", "9", " 3\n7 8 9 3\n"}},
      {".csv", {"x,y,z,r\n", "7", ",", "8", ",", "9", ",", "3", "\n"}},
      {".obj", {"v ", "7", " ", "8", " ", "9", "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}},
      {".off", {"OFF\n3 1 0\n", "7", " ", "8", " ", "9", "\n1 0 0\n0 1 0\n3 0 1 2\n"}},
      {".pcd",
       {"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n", "7", " ", "8", " ", "9", "\n"}}};
  for (const auto& [ending, pieces] : files)
    for (std::size_t which = 1; which + 1 < pieces.size(); which += 2)
      for (const char* spelt : {"1.#IND", "-1.#IND", "1.#QNAN", "1.#INF"}) {
        std::string text;
        for (std::size_t k = 0; k < pieces.size(); ++k) text += k == which ? spelt : pieces[k];
        INFO(ending << ' ' << text);
        CHECK(read_all(ending, text).starts_with(':'));
      }
  CHECK(read_all(".xyz", "1 2 3 # 4\n5,6,7,#8\n") == read_all(".xyz", "1 2 3\n5 6 7\n"));
}

TEST_CASE("binary PCD data may begin with any byte, and POINTS is what the data hold") {
  for (const char* end : ends)
    for (int first = 0; first < 256; ++first) {
      const std::string header =
          with_ends("VERSION .7\nFIELDS x y z\nSIZE 1 1 1\nTYPE U U U\nWIDTH 2\nHEIGHT 1\nDATA binary\n", end);
      const std::string data = {char(first), 10, 13, 13, 10, char(first)};
      const scratch_file file(".pcd", header + data);
      const io::cloud c = io::load_pcd(file.path);
      REQUIRE(c.points.size() == 2);
      CHECK(c.points[0].x() == first);
    }
  const std::string header = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nDATA binary\n";
  for (int records = 0; records <= 4; ++records) {
    std::string data;
    for (int i = 0; i < 3 * records; ++i) {
      const float v = 1 + float(i);
      data.append(reinterpret_cast<const char*>(&v), 4);
    }
    const std::string said = refusal([&] { io::read_pcd(header + data, "made.pcd"); });
    INFO(said);
    CHECK(said.empty() == (records == 2));
    if (records == 2)
      CHECK(refusal([&] { io::read_pcd(header + data + std::string(1000, '\0'), "made.pcd"); }).empty());
    if (records == 2) CHECK_FALSE(refusal([&] { io::read_pcd(header + data + 'x', "made.pcd"); }).empty());
  }
}

TEST_CASE("an ascii PCD coordinate fits its TYPE and SIZE, and no header entry is given twice") {
  const auto read = [](const std::string& type, const std::string& size, const std::string& word) {
    return refusal([&] {
      io::read_pcd("FIELDS x y z\nSIZE " + size + " 4 4\nTYPE " + type + " F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n" +
                       word + " 0 0\n",
                   "made.pcd");
    });
  };
  for (const int size : {1, 2, 4, 8}) {
    const double most = std::exp2(8 * size);
    const std::string text = std::to_string(size);
    const auto spelt = [](double v) {
      char word[64];
      std::snprintf(word, sizeof word, "%.0f", v);
      return std::string(word);
    };
    CHECK(read("U", text, "0").empty());
    CHECK(read("U", text, spelt(size < 8 ? most - 1 : most / 2)).empty());
    CHECK_FALSE(read("U", text, spelt(most)).empty());
    CHECK_FALSE(read("U", text, "-1").empty());
    CHECK(read("I", text, spelt(-most / 2)).empty());
    CHECK_FALSE(read("I", text, spelt(most / 2)).empty());
    for (const char* word : {"0.5", "nan", "inf", "x", "1e400"}) {
      CHECK_FALSE(read("U", text, word).empty());
      CHECK_FALSE(read("I", text, word).empty());
    }
  }
  CHECK(read("F", "4", "3e38").empty());
  CHECK_FALSE(read("F", "4", "3.5e38").empty());
  CHECK(read("F", "8", "3.5e38").empty());
  CHECK_FALSE(read("F", "8", "1e309").empty());
  CHECK(read("F", "8", "nan").empty());
  const std::vector<std::string> entries = {"VERSION .7",  "FIELDS x y z", "SIZE 4 4 4", "TYPE F F F",
                                            "COUNT 1 1 1", "WIDTH 1",      "HEIGHT 1",   "VIEWPOINT 0 0 0 1 0 0 0",
                                            "POINTS 1"};
  for (std::size_t twice = 0; twice <= entries.size(); ++twice) {
    std::string text;
    for (std::size_t i = 0; i < entries.size(); ++i) text += entries[i] + '\n' + (i == twice ? entries[i] + '\n' : "");
    CHECK(refusal([&] { io::read_pcd(text + "DATA ascii\n1 2 3\n", "made.pcd"); }).empty() ==
          (twice == entries.size()));
  }
}

}  // namespace text_lines_test
