// SPDX-License-Identifier: BSD-3-Clause
#include "io/damage.hpp"
#include "io/xml.hpp"

#include <clearance/io/mesh.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <sstream>

namespace mesh_damage_test {

using namespace clearance;

namespace {

/// Every kind of faces, transform and instance that is read, and the materials that are passed over.
const std::string seed = R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><contributor><author>a test</author></contributor><unit name="centimeter" meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="c"><phong/></technique></profile_COMMON></effect></library_effects>
<library_geometries><geometry id="g" name="box"><mesh>
<source id="p"><float_array id="pa" count="24">-10 -10 -10 10 -10 -10 -10 10 -10 10 10 -10 -10 -10 10 10 -10 10 -10 10 10 10 10 10</float_array><technique_common><accessor source="#pa" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<source id="n"><float_array id="na" count="3">0 0 1</float_array><technique_common><accessor source="#na" count="1" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="2" material="m"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#n" offset="1"/><p>0 0 2 0 3 0 0 0 3 0 1 0</p></triangles>
<polylist count="2"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4 3</vcount><p>4 5 7 6 0 1 5</p></polylist>
<polygons count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>0 5 4</p><p>2 6 7 3</p></polygons>
<tristrips count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 4 2 6</p></tristrips>
<trifans count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>1 3 7 5</p></trifans>
<lines count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 7</p></lines>
</mesh></geometry></library_geometries>
<library_nodes><node id="part"><translate>0 0 30</translate><instance_geometry url="#g"/></node></library_nodes>
<library_visual_scenes><visual_scene id="s"><node id="n1" name="n1"><matrix>1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1</matrix><rotate>0 0 1 90</rotate><scale>1 2 -1</scale><instance_geometry url="#g"><bind_material><technique_common/></bind_material></instance_geometry><node id="n2"><translate>0 0 30</translate><instance_node url="#part"/></node></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>
</COLLADA>)";

std::string all_of(const triangle_mesh& mesh) {
  std::ostringstream out;
  out.precision(12);
  for (const auto& t : mesh.triangles) {
    for (const auto v : t) out << mesh.vertices[v].transpose() << ' ';
    out << ';';
  }
  return out.str();
}

struct mesh_file {
  robot_folder folder;
  std::string file;
  explicit mesh_file(const std::string& name) : file((folder.path / name).string()) {}
  outcome operator()(const std::string& bytes) const {
    std::ofstream(file, std::ios::binary) << bytes;
    try {
      return {all_of(io::load_mesh(file)), ""};
    } catch (const std::runtime_error& error) {
      return {"", error.what()};
    }
  }
};

std::string word(std::uint32_t value) {
  std::string bytes(4, '\0');
  for (std::size_t k = 0; k < 4; ++k) bytes[k] = char(value >> 8 * k);
  return bytes;
}

std::string glb(std::string json, std::string data) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  return "glTF" + word(2) + word(std::uint32_t(28 + json.size() + data.size())) + word(std::uint32_t(json.size())) +
         "JSON" + json + word(std::uint32_t(data.size())) + std::string("BIN\0", 4) + data;
}

/// A tetrahedron twice: indexed, and as a strip of four vertices.
nlohmann::json glb_json() {
  return nlohmann::json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0, "children": [1, 2], "name": "a"},
              {"mesh": 1, "translation": [0.2, 0, 0], "rotation": [0, 0, 1, 0], "scale": [1, 2, -1], "name": "b"},
              {"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0}, "indices": 1, "mode": 4, "material": 0}]},
               {"primitives": [{"attributes": {"POSITION": 0}, "mode": 5}]}],
    "materials": [{"name": "m", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}],
    "accessors": [{"bufferView": 0, "byteOffset": 4, "componentType": 5126, "count": 4, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 68, "byteStride": 16}, {"buffer": 0, "byteOffset": 68, "byteLength": 24}],
    "buffers": [{"byteLength": 92}]})");
}

std::string glb_bytes() {
  std::string data;
  const auto put = [&](auto value) { data.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const auto& v : {std::array{0.f, 0.f, 0.f}, {1.f, 0.f, 0.f}, {0.f, 1.f, 0.f}, {0.f, 0.f, 1.f}}) {
    put(7.f);  // stride 16, of which the first four bytes are something else
    for (const float x : v) put(x);
  }
  put(0.f);
  for (const int i : {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}) put(std::uint16_t(i));
  return data;
}

std::string dae_with(const std::string& from, const std::string& to) {
  std::string text = seed;
  const std::size_t at = text.find(from);
  REQUIRE(at != text.npos);
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("a damaged number of a COLLADA file is refused, or it was of no use") {
  const mesh_file read("m.dae");
  CHECK(std::ranges::count(read(seed).answer, ';') == 2 * 12);
  std::vector<damaged> all;
  io::xml_element root = io::read_xml(seed, "seed");
  std::set<const io::xml_element*> free;  // lists whose length no count says
  each_element(root, "", [&](io::xml_element& e, const std::string&) {
    for (const auto& child : e.children)
      if (child.name == "p" && one_of(e.name, {"polygons", "tristrips", "trifans"})) free.insert(&child);
    const auto damage = [&](std::string& value, const std::string& what) {
      const std::string kept = value;
      for (const auto& text :
           words_damaged(kept, {"", "nan", "1e999", "0,5", "x", "1 1", "&", "4294967301", "18446744073709551621"})) {
        value = text;
        const bool transform = one_of(e.name, {"matrix", "rotate", "scale", "translate", "float_array", "unit"});
        all.push_back({what + "=" + text, xml_text(root), "", transform && says(text, "42949")});
        all.back().explained |= transform && says(text, "18446");
        all.back().explained |= e.name == "unit" && text == "0,5";  // with a note
        all.back().explained |= free.contains(&e) && text.find_first_not_of("0123456789 ") == text.npos;
      }
      for (const auto& text : words_damaged(kept, {"-1", "0", "2", "1.5"})) {
        value = text;
        all.push_back({what + "=" + text, xml_text(root), "",
                       one_of(e.name, {"matrix", "rotate", "scale", "translate", "float_array", "unit", "p"})});
      }
      value = kept;
    };
    for (auto& [key, value] : e.attributes)
      if (one_of(key, {"count", "stride", "offset", "meter"})) damage(value, e.name + "." + key);
    if (e.text.find_first_not_of(" \t\r\n") != e.text.npos && e.name != "author" && e.name != "up_axis")
      damage(e.text, e.name);
  });
  CHECK(all.size() > 1000);
  check_damages(all, seed, read.file, std::cref(read));
}

TEST_CASE("what is left out of a COLLADA file, renamed or there twice does not change the answer without a word") {
  const mesh_file read("m.dae");
  check_damages(structure_damages(seed,
                                  {"unit", "asset", "matrix", "rotate", "scale", "translate", "node", "instance_node",
                                   "instance_geometry", "triangles", "polylist", "polygons", "tristrips", "trifans"},
                                  {"matrix", "rotate", "scale", "translate", "node", "instance_node",
                                   "instance_geometry", "triangles", "polylist", "polygons", "tristrips", "trifans"},
                                  {"meter"}),
                seed, read.file, std::cref(read));
}

TEST_CASE("a damaged member of a glTF file is refused, or it was of no use") {
  const mesh_file read("m.glb");
  const std::string data = glb_bytes();
  const nlohmann::json whole = glb_json();
  CHECK(std::ranges::count(read(glb(whole.dump(), data)).answer, ';') == 4 + 2 + 4);
  std::vector<damaged> all;
  const nlohmann::json flat = whole.flatten();
  const auto transform = [](const std::string& path) {
    return says(path, "translation") || says(path, "rotation") || says(path, "scale") || says(path, "matrix");
  };
  for (const auto& [path, value] : flat.items()) {
    const nlohmann::json::json_pointer at(path);
    for (const char* other :
         {"-1", "1.5", "4294967301", "18446744073709551616", "\"x\"", "null", "[]", "{}", "true", "99"}) {
      nlohmann::json made = whole;
      made[at] = nlohmann::json::parse(other);
      all.push_back({path + "=" + other, glb(made.dump(), data), "", transform(path) && made[at].is_number()});
    }
    // Members: left out, renamed, there twice.
    nlohmann::json made = whole;
    nlohmann::json& above = made[at.parent_pointer()];
    if (!above.is_object()) continue;
    above.erase(at.back());
    all.push_back({path + " left out", glb(made.dump(), data), "",
                   transform(path) || says(path, "/mesh") || says(path, "byteOffset") || says(path, "mode") ||
                       says(path, "byteStride")});
    above[at.back() + "x"] = value;
    all.push_back({path + " renamed", glb(made.dump(), data), "", false});
    std::string text = whole.dump();
    const std::string member = "\"" + at.back() + "\":" + value.dump();
    text.insert(text.find(member), member + ",");
    all.push_back({path + " twice", glb(text, data), "", false});
  }
  check_damages(all, glb(whole.dump(), data), read.file, std::cref(read));

  const auto refused = [&](const nlohmann::json& json) {
    const outcome made = read(glb(json.dump(), data));
    CHECK_FALSE(made.refusal.empty());
    check_sentence(made.refusal, read.file);
    return made.refusal;
  };
  const auto with = [&](const char* path, const nlohmann::json& value) {
    nlohmann::json made = whole;
    made[nlohmann::json::json_pointer(path)] = value;
    return made;
  };
  CHECK(says(refused(with("/buffers/0/uri", "file:///etc/passwd")), "only files beside this one"));
  CHECK(says(refused(with("/buffers/0/uri", "/dev/zero")), "only files beside this one"));
  CHECK(says(refused(with("/buffers/0/uri", "gone.bin")), "there is no such file"));
  CHECK(says(refused(with("/nodes/0/children", {1, 2, 0})), "elsewhere too"));
  CHECK(says(refused(with("/nodes/1/children", {2})), "elsewhere too"));
  CHECK(says(refused(with("/nodes/0/children", {1})), "no place"));
  CHECK(says(refused(with("/nodes/1/skin", 0)), "skin"));
  CHECK(says(refused(with("/meshes/0/primitives/0/targets", nlohmann::json::array())), "morph"));
  CHECK(says(refused(with("/meshes/0/primitives/0/mode", 7)), "mode 7"));
  CHECK(says(refused(with("/accessors/0/sparse", {{"count", 1}})), "sparse"));
  CHECK(says(refused(with("/extensionsRequired", {"KHR_draco_mesh_compression"})), "KHR_draco_mesh_compression"));
  CHECK(says(refused(with("/accessors/1/count", 0)), "count 0"));
  for (const int off : {1, 2, 3, 5, 6, 7}) CHECK(says(refused(with("/accessors/0/byteOffset", off)), "not aligned"));
  for (const int off : {67, 65}) CHECK(says(refused(with("/bufferViews/1/byteOffset", off)), "not aligned"));
  for (const int stride : {13, 14, 15, 17})
    CHECK(says(refused(with("/bufferViews/0/byteStride", stride)), "not aligned"));
  CHECK(says(refused(with("/nodes/2/scale", {1, 1, 1})), "parts of one"));
  CHECK(says(refused(with("/nodes/1/scale", {0, 1, 1})), "flattens"));
}

TEMPLATE_TEST_CASE("indices of a glTF file have one, two or four bytes each", "", std::uint8_t, std::uint16_t,
                   std::uint32_t) {
  const mesh_file read("m.glb");
  const std::string two = glb_bytes();
  std::string data = two.substr(0, 68);
  for (std::size_t k = 68; k < two.size(); k += 2) {
    const TestType index = std::uint8_t(two[k]);
    data.append(reinterpret_cast<const char*>(&index), sizeof index);
  }
  nlohmann::json json = glb_json();
  json["accessors"][1]["componentType"] = sizeof(TestType) == 1 ? 5121 : sizeof(TestType) == 2 ? 5123 : 5125;
  json["bufferViews"][1]["byteLength"] = 12 * sizeof(TestType);
  json["buffers"][0]["byteLength"] = data.size();
  const outcome made = read(glb(json.dump(), data));
  CHECK(made.refusal == "");
  CHECK(made.answer == read(glb(glb_json().dump(), two)).answer);
}

TEST_CASE("a strip and a fan of a glTF file are the triangles that its page says, and loose triangles fill the limit") {
  const mesh_file read("m.glb");
  const auto of = [](int mode, const std::vector<int>& corners) {
    std::string data;
    for (const int c : corners)
      for (const float x : {float(c), float(c * c % 7), float(c * c * c % 5)})
        data.append(reinterpret_cast<const char*>(&x), sizeof x);
    nlohmann::json json = nlohmann::json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3"}],
      "bufferViews": [{"buffer": 0}], "buffers": [{}]})");
    json["meshes"][0]["primitives"][0]["mode"] = mode;
    json["accessors"][0]["count"] = corners.size();
    json["bufferViews"][0]["byteLength"] = json["buffers"][0]["byteLength"] = data.size();
    return glb(json.dump(), data);
  };
  const auto strip = read(of(5, {0, 1, 2, 3, 4})), fan = read(of(6, {0, 1, 2, 3, 4}));
  CHECK(strip.answer == read(of(4, {0, 1, 2, 2, 1, 3, 2, 3, 4})).answer);
  CHECK(fan.answer == read(of(4, {0, 1, 2, 0, 2, 3, 0, 3, 4})).answer);
  CHECK(std::ranges::count(strip.answer, ';') == 3);
  CHECK(read(of(4, {0, 1, 2, 2, 1, 3})).refusal == "");
  CHECK(io::load_mesh(read.file, {.triangles = 2}).triangles.size() == 2);
  CHECK(says(sentence([&] { io::load_mesh(read.file, {.triangles = 1}); }), "more than the 1 triangles"));
}

TEST_CASE("a strip and a fan of a COLLADA file are the triangles that its page says") {
  const mesh_file read("m.dae");
  const std::string input = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>";
  const auto with = [&](const std::string& strip, const std::string& fan) {
    std::string text = dae_with("<tristrips count=\"1\">" + input + "0 4 2 6</p></tristrips>", strip);
    const std::string old = "<trifans count=\"1\">" + input + "1 3 7 5</p></trifans>";
    return read(text.replace(text.find(old), old.size(), fan));
  };
  const auto made = with("<tristrips count=\"1\">" + input + "0 4 2 6 1</p></tristrips>",
                         "<trifans count=\"1\">" + input + "1 3 7 5 0</p></trifans>");
  CHECK(made.refusal == "");
  CHECK(made.answer == with("<triangles count=\"3\">" + input + "0 4 2 2 4 6 2 6 1</p></triangles>",
                            "<triangles count=\"3\">" + input + "1 3 7 1 7 5 1 5 0</p></triangles>")
                           .answer);
}

TEST_CASE("one byte of a mesh file changed does not change how much there is, unless it is a number") {
  const std::string json = glb(glb_json().dump(), glb_bytes());
  std::string stl = "solid s\n";
  for (int i = 0; i < 4; ++i)
    stl += "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 " + std::to_string(i) +
           "\nvertex 0 1 0\nendloop\nendfacet\n";
  stl += "endsolid s\n";
  for (const auto& [name, whole] :
       {std::pair<std::string, std::string>{"m.dae", seed}, {"m.glb", json}, {"m.stl", stl}}) {
    const mesh_file read(name);
    const auto faces = std::ranges::count(read(whole).answer, ';');
    std::uint32_t random = 99;
    const auto next = [&](std::size_t below) {
      random = random * 1664525u + 1013904223u;
      return std::size_t((std::uint64_t(random) * below) >> 32);
    };
    int refused = 0, answered = 0;
    for (int trial = 0; trial < 1500; ++trial) {
      std::string bytes = whole;
      const std::size_t at = next(bytes.size());
      const char byte = trial % 2 ? "<>&\"/:=-+ .,{}[]0e"[next(18)] : char(next(256));
      const auto counts = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) || c == ' '; };
      const bool numeric = counts(bytes[at]) || counts(byte);  // without a space two numbers become one
      if (trial % 4 == 0)
        bytes.erase(at, 1);
      else if (trial % 4 == 1)
        bytes.insert(at, 1, byte);
      else
        bytes[at] = byte;
      const outcome made = read(bytes);
      INFO(name << " " << trial << ": " << int(byte) << " at " << at << ": " << made.refusal);
      if (!made.refusal.empty()) {
        ++refused;
        check_sentence(made.refusal, read.file);
      } else {
        ++answered;
        if (!numeric && std::ranges::count(made.answer, ';') != faces) FAIL("faces are lost");
      }
    }
    CHECK(refused > 200);
    CHECK(answered > 50);
    for (std::size_t cut = 1; cut < whole.size(); cut += 1 + whole.size() / 300)
      if (const outcome made = read(whole.substr(0, whole.size() - cut)); made.refusal.empty())
        CHECK(std::ranges::count(made.answer, ';') == faces);  // only what follows the end is gone
  }
}

TEST_CASE("a line of an OFF or OBJ file has as many numbers as its kind says, or is refused by its number") {
  const auto numbers = [](std::size_t count) {
    std::string text;
    for (std::size_t k = 0; k < count; ++k) text += " 0.5";
    return text;
  };
  // What a vertex and a face may have after their coordinates and corners.
  const std::set<std::size_t> colour = {0, 1, 3, 4};
  const std::pair<std::string, std::set<std::size_t>> kinds[] = {
      {"OFF", {0}}, {"COFF", {3, 4}}, {"NOFF", {3}}, {"STOFF", {2}}, {"", colour}};
  for (const auto& [kind, allowed] : kinds) {
    const bool off = !kind.empty();
    const mesh_file read(off ? "m.off" : "m.obj");
    const auto text = [&](std::size_t usual, std::size_t damaged, std::size_t more, std::size_t face) {
      std::string made = off ? kind + "\n4 2 0\n" : "# made\n\n";
      int k = 0;
      for (const char* v : {"0 0 0", "1 0 0", "0 1 0", "0 0 1"})
        made += (off ? "" : "v ") + std::string(v) + numbers(k == int(damaged) ? more : usual) + "\n", ++k;
      return made + (off ? "3 0 1 2" + numbers(face) + "\n3 0 1 3\n" : "f 1 2 3\nf 1 2 4\n");
    };
    for (const std::size_t usual : allowed) {
      const outcome whole = read(text(usual, 0, usual, 0));
      REQUIRE(whole.refusal.empty());
      for (std::size_t damaged = 0; damaged < 4; ++damaged)
        for (std::size_t more = 0; more < 12; ++more) {
          const outcome made = read(text(usual, damaged, more, 0));
          INFO(kind << ": vertex " << damaged << " has " << more << " numbers instead of " << usual << ": "
                    << made.refusal);
          const bool fits = off ? more == usual : colour.contains(more);
          CHECK(made.refusal.empty() == fits);
          // Of colours the first vertex says how many there are.
          const std::size_t line = 3 + (damaged == 0 && allowed.contains(more) ? 1 : damaged);
          if (fits)
            CHECK(made.answer == whole.answer);
          else
            CHECK(made.refusal.starts_with(read.file + ":" + std::to_string(line) + ": a vertex of "));
        }
      for (std::size_t face = 0; off && face < 8; ++face) {
        const outcome made = read(text(usual, 0, usual, face));
        CHECK(made.refusal.empty() == colour.contains(face));
        if (made.refusal.empty())
          CHECK(made.answer == whole.answer);
        else
          CHECK(made.refusal.starts_with(read.file + ":7: a face of 3 corners has "));
      }
    }
  }
  const mesh_file off("m.off"), obj("m.obj");
  // What a corner says besides its vertex is passed over, but it must be what may stand there.
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 ";
  for (const char* corner : {"2", "2/1", "2//1", "2/1/1", "2/-1/-1", "2/", "2//", "+2"})
    CHECK(obj(three + corner + " 3\n").refusal.empty());
  for (const char* corner :
       {"2/x", "2/0,5", "2//1d0", "2//0x10", "2/1/0.25", "2/1/1/1", "2///", "/2", "2\\1", "2/1 x", "2/nan"})
    CHECK(says(obj(three + corner + " 3\n").refusal, ":4: "));
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2";
  for (const char* counts : {"3 1", "3 1 0", "3 1 0 # edges"})
    CHECK(off("OFF\n" + std::string(counts) + "\n" + vertices).refusal.empty());
  for (const char* counts : {"3", "3 1 0 0", "3 1 0 0 0 0", "3 1 x"})
    CHECK_FALSE(off("OFF\n" + std::string(counts) + "\n" + vertices).refusal.empty());
  CHECK(says(off("OFF\n3 1 0\n" + vertices + " x").refusal, ":6: \"x\" is not a number"));
  CHECK(off("COFF\n3 1 0\n0 0 0 nan nan nan\n1 0 0 1 1 1\n0 1 0 0 0 0\n3 0 1 2")
            .refusal.empty());  // some tools write that
  // Two lines of an OBJ file that became one.
  const std::vector<std::string> lines = {"v 0 0 0", "v 1 0 0", "v 0 1 0", "v 0 0 1", "vn 0 0 1", "vt 0 1",
                                          "vp 1",    "s off",   "l 1 2",   "p 1",     "f 1 2 3",  "f 1 2 4"};
  for (std::size_t joined = 0; joined < lines.size(); ++joined) {
    std::string text;
    for (std::size_t k = 0; k < lines.size(); ++k) text += lines[k] + (k == joined ? " " : "\n");
    INFO(text);
    const outcome made = obj(text);
    CHECK(made.refusal.empty() == (joined + 1 == lines.size()));
    if (joined + 1 < lines.size()) CHECK(made.refusal.starts_with(obj.file + ":" + std::to_string(joined + 1) + ": "));
  }
}

TEST_CASE("a mesh of too many triangles, with a coordinate that is none, or of several scenes is refused") {
  const mesh_file obj("m.obj"), ply("m.ply"), binary("m.glb");
  CHECK(obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").refusal.empty());
  CHECK(says(sentence([&] { io::load_mesh(obj.file, {.triangles = 1}); }), "more than the 1 triangles"));
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n";
  CHECK(ply(head + "0 1 0\n3 0 1 2\n").refusal.empty());
  for (const std::string z : {"nan", "inf", "-inf"})
    CHECK(says(ply(head + "0 1 " + z + "\n3 0 1 2\n").refusal, ":12: vertex 2 has a coordinate that is not finite"));
  nlohmann::json two = glb_json(), many = glb_json();
  two["scenes"].push_back(two["scenes"][0]);
  CHECK(binary(glb(two.dump(), glb_bytes())).refusal.empty());  // it says which
  two.erase("scene");
  CHECK(says(binary(glb(two.dump(), glb_bytes())).refusal, "has 2 scenes, and does not say which"));
  many["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"] = nlohmann::json::object();
  CHECK(says(binary(glb(many.dump(), glb_bytes())).refusal, "EXT_mesh_gpu_instancing"));
}

TEST_CASE("what a small file unfolds to has limits, which a sentence names and a caller sets") {
  const mesh_file dae("m.dae"), binary("m.glb");
  // COLLADA: nodes inside one another, instances of instances, a node inside itself, many params, deep elements.
  std::string chain, deep;
  for (int i = 0; i < 8; ++i) {
    chain += "<node id=\"c" + std::to_string(i) + "\">";
    for (int k = 0; k < 10; ++k) chain += "<instance_node url=\"#c" + std::to_string(i + 1) + "\"/>";
    chain += "</node>";
  }
  const std::string end = "</visual_scene>";
  CHECK(says(dae(dae_with(end, chain + "<node id=\"c8\"/>" + end)).refusal, "mesh_limits::nodes"));
  CHECK(says(dae(dae_with(end, chain + "<node id=\"c8\"><instance_geometry url=\"#g\"/></node>" + end)).refusal,
             "mesh_limits::"));
  CHECK(says(dae(dae_with(end, "<node id=\"x\"><instance_node url=\"#x\"/></node>" + end)).refusal,
             "mesh_limits::depth"));
  CHECK(says(dae(dae_with(end, "<node id=\"&#x78;\"><instance_node url=\"#&#120;\"/></node>" + end)).refusal,
             "mesh_limits::depth"));
  for (int i = 0; i < 20000; ++i) deep += "<node>";
  CHECK(says(dae(dae_with(end, deep)).refusal, "mesh_limits::depth"));
  std::string params;
  for (int i = 0; i < 100000; ++i) params += "<param name=\"S\" type=\"float\"/>";
  CHECK(dae(dae_with("</accessor>", params + "</accessor>")).answer == dae(seed).answer);
  CHECK(says(dae(dae_with("url=\"#g\"", "url=\"#missing\"")).refusal, "does not exist"));
  CHECK(says(dae(dae_with("url=\"#g\"", "url=\"other.dae#g\"")).refusal, "not in this file"));
  // A count alone must not decide how much memory is taken.
  CHECK(
      says(dae(dae_with("<triangles count=\"2\"", "<triangles count=\"4294967295\"")).refusal, "4294967295 triangles"));
  CHECK(says(dae(dae_with("</vertices>",
                          "</vertices><vertices id=\"w\"><input semantic=\"POSITION\" source=\"#n\"/></vertices>"))
                 .refusal,
             "more than one <vertices>"));
  CHECK(says(
      dae(dae_with("<instance_geometry url=\"#g\">", "<instance_controller url=\"#g\"/><instance_geometry url=\"#g\">"))
          .refusal,
      "<instance_controller> is not known"));
  CHECK(says(dae(dae_with("<scale>1 2 -1", "<skew>0 0 0 0 0 0 0</skew><scale>1 2 -1")).refusal, "<skew>"));

  // glTF: 20,000 nodes inside one another; one mesh at very many places.
  const std::string data = glb_bytes();
  nlohmann::json nested = glb_json(), many = glb_json();
  for (int i = 3; i < 20000; ++i) {
    nested["nodes"].push_back(nlohmann::json::object());
    nested["nodes"][std::size_t(i - 1)]["children"] = {i};
  }
  CHECK(says(binary(glb(nested.dump(), data)).refusal, "mesh_limits::depth"));
  for (int i = 3; i < 120'000; ++i) {
    many["nodes"].push_back({{"mesh", 0}});
    many["scenes"][0]["nodes"].push_back(i);
  }
  CHECK(says(binary(glb(many.dump(), data)).refusal, "mesh_limits::"));
  CHECK(says(binary(glb(std::string(1'000'000, '['), data)).refusal, "JSON"));
  std::string zeros = "[0";
  for (int i = 0; i < 2'100'000; ++i) zeros += ",0";
  CHECK(says(binary(glb("{\"asset\":" + zeros + "]}", data)).refusal, "mesh_limits::values"));

  const std::string file = (dae.folder.path / "m.dae").string();
  dae(seed);
  const auto within = [&](auto change) {
    io::mesh_limits limits;
    change(limits);
    return sentence([&] { io::load_mesh(file, limits); });
  };
  CHECK(within([](io::mesh_limits&) {}).empty());
  CHECK(says(within([](io::mesh_limits& l) { l.bytes = 100; }), "mesh_limits::bytes"));
  CHECK(says(within([](io::mesh_limits& l) { l.triangles = 20; }), "mesh_limits::triangles"));
  CHECK(says(within([](io::mesh_limits& l) { l.values = 20; }), "mesh_limits::values"));
  CHECK(says(within([](io::mesh_limits& l) { l.nodes = 2; }), "mesh_limits::nodes"));
  CHECK(says(within([](io::mesh_limits& l) { l.depth = 3; }), "mesh_limits::depth"));
}

}  // namespace mesh_damage_test
