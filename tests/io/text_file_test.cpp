// SPDX-License-Identifier: BSD-3-Clause
// Text that Windows tools save, in every format of text: the same content, or a refusal that names the encoding.
#include "io/gltf_files.hpp"
#include "io/robot_folder.hpp"
#include "support/catch.hpp"

#include <clearance/io/cloud_file.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/io/spheres_file.hpp>

#include <sstream>

namespace text_file_test {

using namespace clearance;

namespace {

enum class order { low, high };

std::string utf16(std::u16string_view text, order first, bool mark) {
  std::string made;
  const auto put = [&](char16_t c) {
    const char low = char(c & 0xFF), high = char(c >> 8);
    (made += first == order::low ? low : high) += first == order::low ? high : low;
  };
  if (mark) put(0xFEFF);
  for (const char16_t c : text) put(c);
  return made;
}
std::string utf16(const std::string& ascii, order first, bool mark) {
  return utf16(std::u16string(ascii.begin(), ascii.end()), first, mark);
}
std::string utf32(const std::string& ascii, order first) {
  std::string made = first == order::low ? std::string("\xFF\xFE\0\0", 4) : std::string("\0\0\xFE\xFF", 4);
  for (const char c : ascii) made += first == order::low ? std::string{c, 0, 0, 0} : std::string{0, 0, 0, c};
  return made;
}

/// All numbers of a file, whatever it holds.
std::string content(const std::filesystem::path& file) {
  std::ostringstream out;
  const std::string end = file.extension().string();
  if (end == ".urdf") {
    const io::robot robot = io::load_robot(file);
    for (const auto& part : robot.parts()) out << part.name << part.mesh.vertices.size();
  } else if (end == ".xyz" || end == ".pcd" || (end == ".ply" && says(file.string(), "cloud"))) {
    for (const auto& p : io::load_cloud(file.string()).points) out << p.transpose() << ';';
  } else if (end == ".csv" || end == ".yaml") {
    for (const auto& part : io::load_spheres(file.string()))
      for (const auto& s : part.spheres.spheres) out << part.name << s.center.x << s.center.y << s.center.z << s.radius;
  } else {
    const triangle_mesh mesh = io::load_mesh(file);
    for (const auto& t : mesh.triangles)
      for (const auto v : t) out << mesh.vertices[v].transpose() << ';';
  }
  return out.str();
}

std::vector<std::pair<std::string, std::string>> texts() {
  const box_mesh box({1, 2, 3});
  const std::string head = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  return {
      {"m.obj", box.obj()},
      {"m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {"m.stl",
       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
       "0\nendloop\nendfacet\nendsolid\n"},
      {"m.ply",
       "ply\nformat ascii 1.0\n" + head +
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {"m.gltf", gltf_of(box, data_uri(box))},
      {"cloud.ply", "ply\nformat ascii 1.0\n" + head + "end_header\n1 2 3\n4 5 6\n7 8 9\n"},
      {"c.xyz", "1 2 3\n4 5 6\n"},
      {"c.pcd",
       "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n1 2 "
       "3\n4 5 6\n"},
      {"s.csv", "x,y,z,r\n1,2,3,4\n"},
      {"s.yaml", "collision_spheres:\n  a:\n    - center: [1, 2, 3]\n      radius: 4\n"},
      {"r.urdf",
       "<robot name=\"r\"><link name=\"a\"><collision><geometry><box size=\"1 1 "
       "1\"/></geometry></collision></link></robot>"},
  };
}

}  // namespace

TEST_CASE("Text in UTF-16 with its mark is what it says, in every format, and other wide text is refused by name") {
  const robot_folder folder;
  for (const auto& [name, text] : texts()) {
    const std::string plain = content(folder.put(name, text));
    REQUIRE(!plain.empty());
    for (const order first : {order::low, order::high}) {
      INFO(name << ' ' << int(first));
      CHECK(content(folder.put(name, utf16(text, first, true))) == plain);
      const std::string half = sentence([&] { content(folder.put(name, utf16(text, first, true) + "x")); });
      CHECK_FALSE(half.empty());
      const std::string unmarked = sentence([&] { content(folder.put(name, utf16(text, first, false))); });
      const bool xml = name == "r.urdf";  // which says by its first character how it is written
      if (!xml)
        CHECK(says(unmarked, name == "m.stl" && first == order::high ? "STL" : "UTF-16 without a byte order mark"));
      if (!xml && name != "m.stl")
        CHECK(says(sentence([&] { content(folder.put(name, utf32(text, first))); }), "UTF-32"));
    }
  }
}

TEST_CASE("Characters beyond ASCII come through UTF-16 whole, and halves of them are refused") {
  const robot_folder folder;
  const auto name = [&](std::u16string_view spelt) {
    std::u16string text = u"collision_spheres:\n  ";
    text += spelt;
    text += u":\n    - {center: [0, 0, 0], radius: 1}\n";
    return io::load_spheres(folder.put("s.yaml", utf16(text, order::low, true)).string()).at(0).name;
  };
  CHECK(name(u"Gelenk_ä") == "Gelenk_\xC3\xA4");
  CHECK(name(u"関節") == "\xE9\x96\xA2\xE7\xAF\x80");
  CHECK(name(u"\U0001F916") == "\xF0\x9F\xA4\x96");
  const char16_t high[] = {0xD83E, 'x', 0}, low[] = {0xDD16, 'x', 0};
  for (const auto* half : {high, low}) CHECK(says(sentence([&] { name(half); }), "half a character"));
}

}  // namespace text_file_test
