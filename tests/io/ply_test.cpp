// SPDX-License-Identifier: BSD-3-Clause
// PLY files from a generator: every type, format and order, compared with the values they were made from.
#include "io/ply_values.hpp"
#include "io/scratch_file.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

#include <clearance/io/cloud_file.hpp>
#include "io/mesh_formats.hpp"

#include <array>
#include <cstring>

namespace ply_test {

using namespace clearance;

namespace {

struct type_law {
  const char *name, *other_name;
  double least, most;  // of whole types all between, of floats the largest finite ones
  bool whole;
};
const type_law types[] = {{"char", "int8", -128, 127, true},
                          {"uchar", "uint8", 0, 255, true},
                          {"short", "int16", -32768, 32767, true},
                          {"ushort", "uint16", 0, 65535, true},
                          {"int", "int32", -0x1p31, 0x1p31 - 1, true},
                          {"uint", "uint32", 0, 0x1p32 - 1, true},
                          {"float", "float32", -0x1.fffffep127, 0x1.fffffep127, false},
                          {"double", "float64", -0x1.fffffffffffffp1023, 0x1.fffffffffffffp1023, false}};

const char* const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};

/// Writes values of any type in one of the formats.
struct ply_writer {
  std::string format, bytes = {}, newline = "\n";

  void header(const std::vector<std::string>& lines) {
    bytes += "ply" + newline + "format " + format + " 1.0" + newline;
    for (const auto& line : lines) bytes += line + newline;
    bytes += "end_header" + newline;
  }
  void word(const std::string& text) { bytes += text + ' '; }
  void put(double value, const std::string& type) {
    if (format == "ascii") {
      char text[400];
      std::snprintf(text, sizeof text, "%.17g", value);
      return word(text);
    }
    const auto as = [&]<class T>(T typed) {
      char raw[sizeof typed];
      std::memcpy(raw, &typed, sizeof typed);
      if (format == "binary_big_endian") std::reverse(raw, raw + sizeof typed);
      bytes.append(raw, sizeof typed);
    };
    if (type == "char" || type == "int8")
      as(std::int8_t(value));
    else if (type == "uchar" || type == "uint8")
      as(std::uint8_t(value));
    else if (type == "short" || type == "int16")
      as(std::int16_t(value));
    else if (type == "ushort" || type == "uint16")
      as(std::uint16_t(value));
    else if (type == "int" || type == "int32")
      as(std::int32_t(value));
    else if (type == "uint" || type == "uint32")
      as(std::uint32_t(value));
    else if (type == "float" || type == "float32")
      as(float(value));
    else
      as(value);
  }
  void end() {
    if (format == "ascii") bytes += newline;
  }
};

std::vector<Eigen::Vector3d> vertices_of(const std::string& bytes) {
  std::vector<Eigen::Vector3d> found;
  std::string_view rest = bytes;
  const io::ply_header header = io::take_ply_header(rest, "made.ply");
  io::read_ply_values(
      rest, header, "made.ply", [&](const auto&, const double* p) { found.emplace_back(p[0], p[1], p[2]); },
      [](const auto&...) {});
  return found;
}

/// Vertices whose y has the given type, with one more property of it, a list of it, and a face before or after them.
struct made_of {
  std::string type, format;
  int vertices = 2;      // that are there
  int said = 2;          // that the header says
  std::string odd = {};  // text for the second vertex's y, in place of a value
  bool face_first = false;
  std::string newline = "\n";

  std::string bytes() const {
    ply_writer out{format, {}, newline};
    const std::vector<std::string> face = {"element face 1", "property list uchar int vertex_indices"};
    std::vector<std::string> lines = face_first ? face : std::vector<std::string>{};
    for (const std::string& line :
         {"element vertex " + std::to_string(said), std::string("property float x"), "property " + type + " y",
          "property list uchar " + type + " extra", std::string("property double z"), "property " + type + " other"})
      lines.push_back(line);
    if (!face_first) lines.insert(lines.end(), face.begin(), face.end());
    out.header(lines);
    const auto put_face = [&] {
      for (const double v : {3.0, 0.0, 1.0, 0.0}) out.put(v, v == 3 ? "uchar" : "int");
      out.end();
    };
    if (face_first) put_face();
    for (int i = 0; i < vertices; ++i) {
      out.put(0.5 + i, "float");
      odd.empty() || i != 1 ? out.put(i + 1, type) : out.word(odd);
      out.put(i, "uchar");
      for (int k = 0; k < i; ++k) out.put(7, type);
      out.put(1e-9 + i, "double");
      out.put(i, type);
      out.end();
    }
    if (!face_first) put_face();
    return out.bytes;
  }
};

std::string fault(const std::string& bytes) {
  return refusal([&] { vertices_of(bytes); });
}

}  // namespace

TEST_CASE("a PLY file of any type, format, order of elements and line end gives its vertices in double") {
  for (const type_law& type : types)
    for (const char* name : {type.name, type.other_name})
      for (const char* format : formats)
        for (const bool face_first : {false, true})
          for (const char* newline : {"\n", "\r\n", "\r"}) {
            const std::string bytes =
                made_of{.type = name, .format = format, .face_first = face_first, .newline = newline}.bytes();
            INFO(bytes.substr(0, 300));
            const auto found = vertices_of(bytes);
            REQUIRE(found.size() == 2);
            CHECK(found[0] == Eigen::Vector3d(0.5, 1, 1e-9));
            CHECK(found[1] == Eigen::Vector3d(1.5, 2, 1 + 1e-9));
            const auto mesh = io::read_ply_mesh(bytes, "made.ply");
            CHECK(mesh.vertices == found);
            CHECK(mesh.corners == std::vector<std::uint32_t>{0, 1, 0});
          }
}

TEST_CASE("a value that does not fit its PLY type is refused, and its bounds are read") {
  for (const type_law& type : types) {
    for (const char* format : formats)
      for (const double bound : {type.least, type.most, 0.0}) {
        ply_writer out{format};
        out.header(
            {"element vertex 1", std::string("property ") + type.name + " x", "property uchar y", "property char z"});
        out.put(bound, type.name), out.put(255, "uchar"), out.put(-128, "char"), out.end();
        INFO(type.name << ' ' << format << ' ' << bound);
        const auto found = vertices_of(out.bytes);
        REQUIRE(found.size() == 1);
        CHECK(found[0] == Eigen::Vector3d(bound, 255, -128));
      }
    char below[64], above[64];
    std::snprintf(below, sizeof below, "%.0f", type.least - 1),
        std::snprintf(above, sizeof above, "%.0f", type.most + 1);
    std::vector<std::string> bad = {"",
                                    "one",
                                    "1,5",
                                    "0x1",
                                    "1e",
                                    "--1",
                                    "+-1",
                                    "1e400",
                                    "-1e400",
                                    "1" + std::string(400, '0'),
                                    "1e999999999999999999999"};
    if (type.whole)
      for (const std::string& more :
           {std::string(below), std::string(above), std::string("0.5"), std::string("1.0"), std::string("1e0"),
            std::string("nan"), std::string("inf"), std::string("99999999999999999999")})
        bad.push_back(more);
    if (std::string(type.name) == "float")
      for (const char* more : {"1e39", "-3.5e38"}) bad.push_back(more);
    for (const std::string& word : bad) {
      INFO(type.name << " \"" << word << '"');
      const std::string said =
          fault(made_of{.type = type.name, .format = "ascii", .odd = word.empty() ? " " : word}.bytes());
      CHECK(said.find("made.ply:") == 0);
      CHECK(said.size() <= 400);
    }
  }
  // Too small for a double is 0, however it is spelt.
  for (const std::string& tiny : {std::string("1e-400"), "0." + std::string(330, '0') + "1",
                                  "-0." + std::string(330, '0') + "1e-3", std::string("1e-999999999999999999999")})
    CHECK(vertices_of(made_of{.type = "double", .format = "ascii", .odd = tiny}.bytes()).at(1).y() == 0);
}

TEST_CASE("a PLY file has as many records as its header says, no fewer and no more") {
  for (const type_law& type : types)
    for (const char* format : formats)
      for (const bool face_first : {false, true})
        for (int there = 0; there <= 4; ++there)
          for (int said = 0; said <= 4; ++said) {
            const std::string bytes =
                made_of{.type = type.name, .format = format, .vertices = there, .said = said, .face_first = face_first}
                    .bytes();
            INFO(type.name << ' ' << format << ' ' << there << ' ' << said << ' ' << face_first);
            CHECK(fault(bytes).empty() == (there == said));
          }
  for (const char* format : formats) {
    const std::string whole = made_of{.type = "float", .format = format}.bytes();
    const bool text = std::string(format) == "ascii";
    CHECK(fault(whole + " \r\n\n").empty() == text);
    CHECK_FALSE(fault(whole + '\0').empty());
    CHECK_FALSE(fault(whole + "1").empty());
    for (std::size_t cut = 0; cut + (text ? 3 : 0) < whole.size(); ++cut)
      CHECK_FALSE(fault(whole.substr(0, cut)).empty());
  }
}

TEST_CASE("binary PLY data may begin with any byte, whatever ends the header's lines") {
  for (const char* format : {"binary_little_endian", "binary_big_endian"})
    for (const char* newline : {"\n", "\r\n", "\r"})
      for (int first = 0; first < 256; ++first) {
        ply_writer out{format, {}, newline};
        out.header({"element vertex 1", "property uchar x", "property uchar y", "property uchar z"});
        for (const int byte : {first, 10, 13}) out.put(byte, "uchar");
        CHECK(vertices_of(out.bytes).at(0) == Eigen::Vector3d(first, 10, 13));
      }
}

TEST_CASE("lists of a PLY file are counted, and corners are checked, in every type") {
  for (const type_law& type : types)
    for (const char* format : formats) {
      const auto with = [&](const std::string& count_type, double count, std::array<double, 3> corners) {
        ply_writer out{format};
        out.header({"element vertex 3", "property float x", "property float y", "property float z", "element face 1",
                    "property list " + count_type + ' ' + type.name + " vertex_indices"});
        for (int i = 0; i < 3; ++i, out.end())
          for (int k = 0; k < 3; ++k) out.put(i * k, "float");
        out.put(count, count_type);
        for (const double corner : corners) out.put(corner, type.name);
        out.end();
        return refusal([&] { io::read_ply_mesh(out.bytes, "made.ply"); });
      };
      INFO(type.name << ' ' << format);
      for (const type_law& count : types) CHECK(with(count.name, 3, {0, 1, 2}).empty() == (type.whole && count.whole));
      if (!type.whole) continue;
      CHECK(with("uchar", 3, {0, 1, 3}).find("has vertex 3, the file has 3") != std::string::npos);
      if (type.least < 0) CHECK(with("uchar", 3, {0, 1, -1}).find("has vertex -1") != std::string::npos);
      CHECK_FALSE(with("char", -3, {0, 1, 2}).empty());
      CHECK_FALSE(with("uchar", 2, {0, 1, 2}).empty());
      CHECK_FALSE(with("uchar", 4, {0, 1, 2}).empty());
      CHECK_FALSE(with("uint", 4294967295.0, {0, 1, 2}).empty());
    }
}

TEST_CASE("a PLY header that says something twice, or nothing that is known, is refused") {
  const std::string good = made_of{.type = "float", .format = "ascii"}.bytes();
  const auto with = [&](const std::string& old, const std::string& now) {
    std::string bytes = good;
    bytes.replace(bytes.find(old), old.size(), now);
    INFO(bytes);
    CHECK(fault(bytes).find("made.ply") == 0);
  };
  with("format ascii 1.0\n", "");
  with("format ascii 1.0\n", "format ascii 1.0\nformat ascii 1.0\n");
  with("format ascii 1.0", "format ascii 2.0");
  with("format ascii 1.0", "format ascii");
  with("element vertex 2", "element vertex");
  with("element vertex 2", "element vertex -2");
  with("element vertex 2", "element vertex 2 2");
  with("element face", "element vertex");
  with("property float x", "property float x\nproperty float x");
  with("property float x", "property half x");
  with("property float x", "property float");
  with("property float x", "properly float x");
  with("property float x", "property float w");
  with("list uchar int", "list float int");
  with("end_header", "end_headers");
  CHECK_FALSE(
      refusal([&] { io::read_ply("ply\nformat ascii 1.0\nelement vertfx 0\nend_header\n", "made.ply"); }).empty());
  const std::string strips =
      "ply\nformat ascii 1.0\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n3 0 1 2\n";
  CHECK_FALSE(refusal([&] { io::read_ply_mesh(strips, "made.ply"); }).empty());
}

TEST_CASE("the PLY files of the attack are read or refused as they should be", "[data]") {
  const std::string folder = testing::data("/attack/");
  if (!std::filesystem::exists(folder)) {
    WARN("SKIPPED: no folder " << folder);
    return;
  }
  CHECK(io::load_ply(folder + "ply-ok.ply").points.size() == 10);
  for (const char* bad : {"ply-neg.ply", "ply-int-shift.ply", "ply-count-low.ply"})
    CHECK_FALSE(refusal([&] { io::load_ply(folder + bad); }).empty());
}

TEST_CASE("triangle strips of a PLY file are triangles that face the same way, and -1 begins a new strip") {
  for (const char* format : formats)
    for (const char* type : {"int", "short", "char"}) {
      const auto strips = [&](const std::vector<std::vector<double>>& lists) {
        ply_writer out{.format = format};
        out.header({"element vertex 6", "property float x", "property float y", "property float z",
                    "element tristrips " + std::to_string(lists.size()),
                    "property list int " + std::string(type) + " vertex_indices"});
        for (int i = 0; i < 6; ++i) {
          for (const double v : {i / 2, i % 2, 0}) out.put(v, "float");
          out.end();
        }
        for (const auto& list : lists) {
          out.put(double(list.size()), "int");
          for (const double v : list) out.put(v, type);
          out.end();
        }
        return out.bytes;
      };
      const auto mesh =
          io::read_ply_mesh(strips({{0, 1, 2, 3, 4, -1, 5, 4, 3, -1}, {0, 1, 2, -1, -1, 1, 3, 2, 4}}), "made.ply");
      CHECK(mesh.corners == std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3, 2, 3, 4, 5, 4, 3, 0, 1, 2, 1, 3, 2, 2, 3, 4});
      CHECK(mesh.ends.size() == 7);
      for (const std::vector<double>& bad : {std::vector<double>{0, 1, 2, -1, 3, 4},
                                             {0, 1, -1, 2, 3, 4},
                                             {0, -1, 2, 3, 4},
                                             {0, 1},
                                             {0, 1, 6},
                                             {0, 1, -2},
                                             {}})
        CHECK_FALSE(refusal([&] { io::read_ply_mesh(strips({bad}), "made.ply"); }).empty());
    }
}

TEST_CASE(
    "PLY faces in an element that is not known are refused, and what some writers get wrong in the header is not") {
  const std::string vertices = "property float x\nproperty float y\nproperty float z\n",
                    three = "0 0 0\n1 0 0\n0 1 0\n";
  const std::string list = "property list uchar int vertex_indices\n";
  const auto with = [&](const std::string& elements, const std::string& records) {
    return "ply\nformat ascii 1.0\nelement vertex 3\n" + vertices + "element face 1\n" + list + elements +
           "end_header\n" + three + "3 0 1 2\n" + records;
  };
  for (const char* name : {"multi_face", "faces", "polygon", "cell", "range_grid"})
    for (const char* indices : {"vertex_indices", "vertex_index"}) {
      const std::string more = "element " + std::string(name) + " 1\nproperty list uchar int " + indices + "\n";
      const std::string said = refusal([&] { io::read_ply_mesh(with(more, "3 0 2 1\n"), "made.ply"); });
      INFO(said);
      CHECK(said.find("made.ply: has the element \"" + std::string(name) + "\"") == 0);
      CHECK(io::read_ply(with(more, "3 0 2 1\n"), "made.ply").points.size() == 3);  // a cloud is what it was
    }
  CHECK(io::read_ply_mesh(with("element none 0\n" + list, ""), "made.ply").ends.size() == 1);
  CHECK(io::read_ply_mesh(with("element edge 1\nproperty int vertex1\nproperty int vertex2\n", "0 1\n"), "made.ply")
            .ends.size() == 1);
  const std::string good = with("", "");
  for (const std::string& head :
       {std::string("PLY\n"), std::string("ply\nCreated by Blender3D 247 - www.blender.org, source file: \n")})
    CHECK(io::read_ply_mesh(head + good.substr(4), "made.ply").ends.size() == 1);
  CHECK_FALSE(refusal([&] { io::read_ply_mesh("Ply" + good.substr(3), "made.ply"); }).empty());
  CHECK_FALSE(refusal([&] { io::read_ply_mesh("ply\nCreated on a day\n" + good.substr(4), "made.ply"); }).empty());
}

}  // namespace ply_test
