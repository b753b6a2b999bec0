// SPDX-License-Identifier: BSD-3-Clause
// Files that repeat one thing so often that a reader whose time or memory grows with the square would not end. All of
// these took minutes, or gigabytes, before their readers were mended.

#include "io/damage.hpp"
#include "io/near_word.hpp"

#include <clearance/io/cloud_file.hpp>
#include <clearance/io/mesh.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/io/spheres_file.hpp>

#include <ctime>

namespace hostile_size_test {

using namespace clearance;

namespace {

/// `text(i)` for each i below `count`, joined.
template <class Text>
std::string repeated(std::size_t count, Text text) {
  std::string made;
  for (std::size_t i = 0; i < count; ++i) made += text(std::to_string(i));
  return made;
}

/// Reads a file of these bytes in less than 20 s of the processor; returns the refusal, or nothing.
template <class Read>
std::string soon(const std::string& name, const std::string& bytes, Read read) {
  const robot_folder folder;
  const std::string file = folder.put(name, bytes).string();
  const std::clock_t begun = std::clock();
  const std::string why = sentence([&] { read(file); });
  CHECK(double(std::clock() - begun) / CLOCKS_PER_SEC < 20);
  return why;
}

std::string collada(const std::string& attributes, const std::string& nodes) {
  return R"(<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1")" + attributes +
         R"(><library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v">
<input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>
</library_geometries>
)" + nodes +
         R"(</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}
const std::string one_node =
    R"(<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node>)";

const auto load_mesh = [](const std::string& file) { io::load_mesh(file); };
const auto load_cloud = [](const std::string& file) { io::load_cloud(file); };

}  // namespace

TEST_CASE("an element of very many attributes is read in time") {
  const std::string many = repeated(300'000, [](const std::string& i) { return " a:x" + i + "=\"\""; });
  CHECK(soon("m.dae", collada(many + " xmlns:a=\"u\"", one_node), load_mesh).empty());
  CHECK(says(soon("m.dae", collada(many, one_node), load_mesh), "a prefix that is not declared"));
  // A prefix is declared within its element only.
  const std::string inner = R"(<asset><extra xmlns:a="u" a:x=""/></asset>)";
  CHECK(soon("m.dae", collada("", inner + one_node), load_mesh).empty());
  CHECK(says(soon("m.dae", collada("", inner + "<extra a:x=\"\"/>" + one_node), load_mesh), "that is not declared"));
}

TEST_CASE("what a COLLADA node holds counts each time that the node is placed") {
  const std::string moves = repeated(100'000, [](const std::string&) { return "<translate>0 0 0</translate>"; });
  const std::string places = repeated(40'000, [](const std::string&) { return "<instance_node url=\"#n\"/>"; });
  const std::string text = collada("", "<library_nodes><node id=\"n\">" + moves + "</node></library_nodes>" + one_node +
                                           "<node>" + places + "</node>");
  CHECK(
      says(soon("m.dae", text, load_mesh), "elements in its nodes, instances counted each time (mesh_limits::values)"));
}

TEST_CASE("primitives of a glTF mesh that share their vertices count each") {
  constexpr std::size_t vertices = 200'000;
  std::string data(12 * vertices + 12, '\0');
  data[12 * vertices + 4] = 1, data[12 * vertices + 8] = 2;
  const std::string size = std::to_string(12 * vertices);
  const std::string primitive = R"({"attributes":{"POSITION":0},"indices":1})";
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[)" +
      primitive + repeated(100'000, [&](const std::string&) { return "," + primitive; }) +
      R"(]}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" + std::to_string(vertices) +
      R"(,"type":"VEC3"},{"bufferView":1,"componentType":5125,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":)" +
      size + R"(},{"buffer":0,"byteOffset":)" + size + R"(,"byteLength":12}],"buffers":[{"byteLength":)" +
      std::to_string(data.size()) + "}]}";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto word = [](std::size_t value) {
    std::string bytes;
    for (int k = 0; k < 4; ++k) bytes += char(value >> 8 * k);
    return bytes;
  };
  const std::string file = "glTF" + word(2) + word(28 + json.size() + data.size()) + word(json.size()) + "JSON" + json +
                           word(data.size()) + std::string("BIN\0", 4) + data;
  CHECK(says(soon("m.glb", file, load_mesh), "with all its primitives, more than the 5000000 triangles"));
}

TEST_CASE("a PLY header of very many elements or properties is read in time") {
  const std::string begin =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string properties = repeated(300'000, [](const std::string& i) { return "property char a" + i + "\n"; });
  const std::string elements =
      repeated(300'000, [](const std::string& i) { return "element a" + i + " 0\nproperty char b\n"; });
  const std::string zeros = repeated(300'003, [](const std::string&) { return "0 "; });
  CHECK(soon("c.ply", begin + properties + "end_header\n" + zeros + '\n', load_cloud).empty());
  CHECK(soon("c.ply", begin + elements + "end_header\n0 0 0\n", load_cloud).empty());
  CHECK(says(soon("c.ply", begin + elements + "element a7 0\nend_header\n0 0 0\n", load_cloud), "is declared twice"));
}

TEST_CASE("joints that follow joints of other files are few, or refused") {
  const auto robot = [](std::size_t count) {
    return "<robot name=\"r\"><link name=\"b\"><collision><geometry><box size=\"1 1 "
           "1\"/></geometry></collision></link>" +
           repeated(count,
                    [](const std::string& i) {
                      return "<link name=\"" + i + "\"/><joint name=\"j" + i +
                             "\" type=\"continuous\"><parent link=\"b\"/><child link=\"" + i +
                             "\"/><mimic joint=\"other" + i + "\"/></joint>";
                    }) +
           "</robot>";
  };
  const auto load = [](const std::string& file) { io::load_robot(file); };
  CHECK(soon("r.urdf", robot(1000), load).empty());
  CHECK(says(soon("r.urdf", robot(100'000), load), "more than 1000 joints follow joints that are not in this file"));
}

TEST_CASE("words that are one letter off are those whose edit distance is 1") {
  const std::string letters = "ab";
  std::vector<std::string> words = {""};
  for (std::size_t from = 0, size = 0; size < 5; ++size)  // all words of up to five letters
    for (const std::size_t end = words.size(); from < end; ++from)
      for (const char c : letters) words.push_back(words[from] + c);
  std::size_t off = 0, wrong = 0;
  for (const auto& a : words)
    for (const auto& b : words) {
      const bool one = io::one_letter_off(a, b);
      off += one;
      wrong += one != (io::edit_distance(a, b) == 1);
    }
  CHECK(words.size() == 63);
  CHECK(off > 300);
  CHECK(wrong == 0);
}

TEST_CASE("a YAML file of very many values is refused before it takes memory") {
  const std::string text = "collision_spheres:\n  a:\n" + repeated(300'000, [](const std::string& i) {
                             return "    - {center: [0, 0, " + i + "], radius: 1}\n";
                           });
  const auto load = [](const std::string& file) { io::load_spheres_yaml(file); };
  CHECK(says(soon("s.yaml", text, load), "YAML values (mesh_limits::values)"));
  CHECK(soon("s.yaml", "collision_spheres:\n  a:\n    - {center: [0, 0, 1], radius: 1}\n", load).empty());
}

}  // namespace hostile_size_test
