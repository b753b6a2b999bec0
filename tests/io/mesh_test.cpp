// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh_polygons.hpp"
#include "io/robot_folder.hpp"
#include "io/scratch_file.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

#include <clearance/io/mesh.hpp>

#include <cmath>
#include <cstring>
#include <numbers>
#include <set>

namespace mesh_test {

using namespace clearance;
using io::load_mesh;

namespace {

/// A triangle for each i, its first corner at (i, 0, 0).
std::string binary_stl(std::uint32_t stated, int triangles, const std::string& header = "made by a test") {
  std::string bytes = header + std::string(80 - header.size(), ' ') + raw_bytes(stated);
  for (int i = 0; i < triangles; ++i)
    bytes += raw_bytes(0.f, 0.f, 1.f, float(i), 0.f, 0.f, float(i) + 1, 0.f, 0.f, float(i), 1.f, 0.f) +
             raw_bytes(std::uint16_t(0));
  return bytes;
}

const std::string ascii_stl =
    "solid a name of words\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1e0 0 0\n   vertex 0 1 0.5\n"
    "  endloop\n endfacet\nendsolid a name of words\n";

std::string dae(const std::string& head, const std::string& nodes, const std::string& array_count = "9",
                const std::string& accessor_count = "3", const std::string& corners = "0 1 2") {
  return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">"
         "<asset>" +
         head +
         "</asset><library_geometries><geometry id=\"g\"><mesh><source id=\"s\"><float_array id=\"a\" "
         "count=\"" +
         array_count + "\">0 0 0 1 0 0 0 2 3</float_array><technique_common><accessor source=\"#a\" count=\"" +
         accessor_count +
         "\" stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/>"
         "<param name=\"Z\" type=\"float\"/></accessor></technique_common></source><vertices id=\"v\"><input "
         "semantic=\"POSITION\" source=\"#s\"/></vertices><triangles count=\"1\"><input semantic=\"VERTEX\" "
         "source=\"#v\" "
         "offset=\"0\"/><p>" +
         corners +
         "</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>"
         "<visual_scene id=\"vs\">" +
         nodes +
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene "
         "url=\"#vs\"/></scene></COLLADA>";
}

const std::string one_node = "<node id=\"n\"><translate>1 0 0</translate><instance_geometry url=\"#g\"/></node>";

/// Twice the sum of the triangles' areas as vectors: that of a flat polygon whatever its triangles are.
Eigen::Vector3d area(const triangle_mesh& mesh) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& [a, b, c] : mesh.triangles)
    sum += (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
  return sum;
}

double unsigned_area(const triangle_mesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm();
  return sum;
}

}  // namespace

TEST_CASE("one triangle is the same from every format") {
  const robot_folder folder;
  const std::string ply_head =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n";
  const std::string positions = raw_bytes(0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, .5f);
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.stl", ascii_stl},
      {"upper.STL", ascii_stl},
      {"no_ending", ascii_stl},
      {"b.stl", std::string(80, ' ') + raw_bytes(std::uint32_t(1)) + raw_bytes(0.f, 0.f, 0.f) + positions +
                    raw_bytes(std::uint16_t(7))},
      {"solid.stl", "solid" + std::string(75, ' ') + raw_bytes(std::uint32_t(1)) + raw_bytes(0.f, 0.f, 0.f) +
                        positions + raw_bytes(std::uint16_t(7))},
      {"c.obj", "v 0 0 0\nv 1 0 0\nv 0 +1. .5e0 1.0\nvn 0 0 1\nf 1//1 2//1 \\\r\n -1//1 # last\r\n"},
      {"d.off", "# comment\nOFF 3 1 0\n0 0 0\n1 0 0 # here\n\n0 1 0.5\n3 0 1 2 255 0 0\n"},
      {"e.ply", "ply\nformat ascii 1.0\n" + ply_head + "0 0 0\n1 0 0\n0 1 0.5\n3 0 1 2\n"},
      {"f.ply", "ply\nformat binary_little_endian 1.0\n" + ply_head + positions + raw_bytes(std::uint8_t(3)) +
                    raw_bytes(0, 1, 2)},
      {"g.dae", dae("<unit meter=\"1\"/><up_axis>Z_UP</up_axis>",
                    "<node id=\"n\"><matrix>1 0 0 0 0 0.5 0 0 0 0 "
                    "0.16666667163372039795 0 0 0 0 1</matrix><instance_geometry url=\"#g\"/></node>")},
  };
  for (const auto& [name, bytes] : files) {
    INFO(name);
    const triangle_mesh mesh = load_mesh(folder.put(name, bytes));
    REQUIRE(mesh.triangles.size() == 1);
    const Eigen::Vector3d expected[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5}};
    for (int i = 0; i < 3; ++i) CHECK((mesh.vertices[mesh.triangles[0][std::size_t(i)]] - expected[i]).norm() < 1e-7);
  }
}

TEST_CASE("triangles keep the order of the file, across materials and objects") {
  const robot_folder folder;
  std::string obj;
  for (int i = 0; i < 30; ++i)
    obj += "o part" + std::to_string(i % 3) + "\nusemtl m" + std::to_string(i % 2) + "\nv " + std::to_string(i) +
           " 0 0\nv 0 1 0\nv 0 0 1\nf -3 -2 -1\n";
  for (const auto& file : {folder.put("a.obj", obj), folder.put("a.stl", binary_stl(30, 30))}) {
    const triangle_mesh mesh = load_mesh(file);
    REQUIRE(mesh.triangles.size() == 30);
    for (std::size_t i = 0; i < 30; ++i) CHECK(mesh.vertices[mesh.triangles[i][0]].x() == double(i));
  }
}

TEST_CASE("text formats keep doubles") {
  const robot_folder folder;
  const triangle_mesh mesh = load_mesh(folder.put("a.obj", "v 5000000.123456789 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n"));
  CHECK(mesh.vertices[0].x() == 5000000.123456789);
}

TEST_CASE("a concave polygon becomes triangles that cover it once") {
  const robot_folder folder;
  // A comb: every second corner is reflex.
  std::string points, face = "f";
  int n = 0;
  const auto add = [&](double x, double y) {
    points += "v 100 " + std::to_string(x) + " " + std::to_string(y) + "\n";
    face += " " + std::to_string(++n);
  };
  add(0, 0);
  add(20, 0);
  for (int i = 20; i >= 0; --i) add(i, i % 2 ? 1 : 5);
  const triangle_mesh mesh = load_mesh(folder.put("comb.obj", points + face + "\n"));
  CHECK(mesh.triangles.size() == std::size_t(n - 2));
  CHECK(area(mesh).x() == Approx(2 * 60));
  CHECK(unsigned_area(mesh) == Approx(2 * 60));

  const triangle_mesh convex = load_mesh(folder.put("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"));
  CHECK(convex.triangles == std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}});
  // A bow tie and a polygon without area stay whole in number.
  CHECK(load_mesh(folder.put("bow.obj", "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n")).triangles.size() == 2);
  CHECK(load_mesh(folder.put("flat.obj", "v 0 0 0\nv 1 1 0\nf 1 2 1 2 1\n")).triangles.size() == 3);
}

TEST_CASE("a polygon of very many corners is covered once, or refused, and never something else") {
  const auto comb = [](std::size_t teeth) {  // two corners a tooth, of area 5.5, and a strip of height 1 below
    io::polygon_mesh made;
    for (std::size_t i = 2 * teeth; i-- > 0;) made.vertices.push_back({double(i), i % 2 ? 10.0 : 1.0, 0});
    made.vertices.push_back({0, 0, 0});
    made.vertices.push_back({2.0 * double(teeth) - 1, 0, 0});
    return made;
  };
  const auto disc = [](std::size_t corners) {
    io::polygon_mesh made;
    for (std::size_t i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * double(i) / double(corners);
      made.vertices.push_back({std::cos(angle), std::sin(angle), 0});
    }
    return made;
  };
  const auto cut = [](io::polygon_mesh mesh, std::size_t patience = io::usual_patience) {
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) mesh.corners.push_back(std::uint32_t(i));
    mesh.ends = {mesh.corners.size()};
    return io::triangulate(std::move(mesh), "m.obj", patience);
  };
  CHECK(unsigned_area(cut(comb(2500))) == Approx(2 * 5.5 * 4999));
  const std::string why = sentence([&] { cut(comb(2500), 5'000'000); });
  CHECK(why == "m.obj: has a face of 5002 corners that is too intricate to be cut into triangles here");
  const double round = std::sin(2 * std::numbers::pi / 3000) * 3000;  // twice the area
  CHECK(unsigned_area(cut(disc(3000))) == Approx(round));
  CHECK(unsigned_area(cut(disc(3000), 100'000)) == Approx(round));  // a fan will do
  // All faces of a file share the patience.
  std::size_t enough = 0;
  while (!sentence([&] { cut(comb(50), enough); }).empty()) enough += 100;
  io::polygon_mesh two = comb(50);
  for (const std::size_t end : {102, 204}) {
    for (std::uint32_t i = 0; i < 102; ++i) two.corners.push_back(i);
    two.ends.push_back(end);
  }
  CHECK(enough > 1000);
  CHECK(says(sentence([&] { io::triangulate(io::polygon_mesh(two), "m.obj", enough); }), "a face of 102 corners"));
  CHECK(io::triangulate(io::polygon_mesh(two), "m.obj").triangles.size() == 200);
}

TEST_CASE("a COLLADA file's unit counts, its up axis does not, and a mirrored node still faces out") {
  const robot_folder folder;
  for (const std::string axis : {"X_UP", "Y_UP", "Z_UP"}) {
    INFO(axis);
    const auto mesh = load_mesh(
        folder.put("a.dae", dae("<unit meter=\"0.5\" name=\"half\"/><up_axis>" + axis + "</up_axis>", one_node)));
    CHECK((mesh.vertices[mesh.triangles[0][0]] - Eigen::Vector3d(0.5, 0, 0)).norm() < 1e-7);
    CHECK((mesh.vertices[mesh.triangles[0][2]] - Eigen::Vector3d(0.5, 1, 1.5)).norm() < 1e-7);
  }
  const std::string scaled = "<node id=\"n\"><scale>-1 1 1</scale><instance_geometry url=\"#g\"/></node>";
  const auto mirrored = load_mesh(folder.put("m.dae", dae("", scaled)));
  // The normal is mirrored as an arrow is: (0, -3, 2) keeps its y and z.
  CHECK((area(mirrored) - Eigen::Vector3d(0, -3, 2)).norm() < 1e-6);
  const auto twice =
      load_mesh(folder.put("t.dae", dae("", one_node + "<node id=\"o\"><instance_geometry url=\"#g\"/></node>")));
  CHECK(twice.triangles.size() == 2);
}

TEST_CASE("a normal of an STL text may be no number as old runtimes spell it, a vertex may not") {
  const robot_folder folder;
  for (const std::string spelt : {"nan", "-nan(ind)", "-1.#IND", "1.#QNAN00", "-1.#INF"}) {
    std::string normal = ascii_stl, vertex = ascii_stl;
    normal.replace(normal.find("0 0 1"), 5, spelt + " " + spelt + " 0");
    vertex.replace(vertex.find("1e0"), 3, spelt);
    CHECK(load_mesh(folder.put("n.stl", normal)).triangles.size() == 1);
    CHECK_FALSE(sentence([&] { load_mesh(folder.put("v.stl", vertex)); }).empty());
  }
}

TEST_CASE("a COLLADA file has one unit and one up axis, or is refused, wherever another is stated") {
  const robot_folder folder;
  const auto with = [&](const std::string& before, const std::string& own) {
    std::string text = dae("<unit meter=\"0.01\"/><up_axis>Z_UP</up_axis>", one_node);
    const std::size_t at = text.find(before);
    REQUIRE(at != text.npos);
    text.insert(text.find('>', at) + 1, "<asset><created>2026</created>" + own + "</asset>");
    return sentence([&] { load_mesh(folder.put("a.dae", text)); });
  };
  for (const char* place :
       {"<library_geometries", "<geometry ", "<source ", "<library_visual_scenes", "<visual_scene ", "<node "}) {
    INFO(place);
    for (const char* same :
         {"", "<unit meter=\"0.01\"/>", "<unit meter=\"1e-2\" name=\"cm\"/>", "<up_axis> Z_UP </up_axis>"})
      CHECK(with(place, same) == "");
    CHECK(says(with(place, "<unit meter=\"10\"/>"), "has a unit of 10 m of its own, the file's is 0.01 m"));
    CHECK(says(with(place, "<unit/>"), "has a unit of 1 m of its own"));
    CHECK(says(with(place, "<up_axis>Y_UP</up_axis>"), "has an up axis \"Y_UP\" of its own"));
    CHECK(says(with(place, "<unit meter=\"nan\"/>"), "not one finite number"));
    CHECK_FALSE(with(place, "<unit meter=\"0.01\"/></asset><asset><unit meter=\"10\"/>").empty());
  }
}

TEST_CASE("less than a triangle after the last one of a binary STL file is passed over with a note, and no more") {
  const robot_folder folder;
  const std::string whole = binary_stl(3, 3);
  for (std::size_t more = 0; more <= 120; ++more) {
    const auto file = folder.put("a.stl", whole + std::string(more, more % 2 ? '\0' : 'x'));
    INFO(more);
    if (more >= 50) {
      CHECK_FALSE(sentence([&] { load_mesh(file); }).empty());
      continue;
    }
    const io::loaded_mesh read = io::load_mesh_noted(file);
    CHECK(read.mesh.triangles.size() == 3);
    CHECK(read.notes.size() == (more > 0 ? 1 : 0));
  }
}

TEST_CASE("a COLLADA accessor that counts floats is taken so, with a note, and no index beyond its array") {
  const robot_folder folder;
  const auto load = [&](const std::string& count, const std::string& corners) {
    return io::load_mesh_noted(folder.put("a.dae", dae("", one_node, "9", count, corners)));
  };
  const io::loaded_mesh floats = load("9", "0 1 2"), positions = load("3", "0 1 2");
  CHECK(floats.mesh.vertices == positions.mesh.vertices);
  CHECK(positions.notes.empty());
  REQUIRE(floats.notes.size() == 1);
  CHECK(says(floats.notes[0], "counts floats"));
  for (const std::string count : {"4", "8", "10", "27"})
    CHECK(says(sentence([&] { load(count, "0 1 2"); }), "needs more values"));
  for (const std::string corners : {"0 1 3", "0 1 8", "0 1 9"})
    CHECK(says(sentence([&] { load("9", corners); }), "has the vertex"));
}

TEST_CASE("a COLLADA unit with a decimal comma is read with a note, unless it may be a thousand") {
  const robot_folder folder;
  const auto file = [&](const std::string& meter) {
    return folder.put("a.dae", dae("<unit meter=\"" + meter + "\"/>", one_node));
  };
  for (const auto& [comma, point] :
       {std::pair{"0,01", "0.01"}, {"0,001", "0.001"}, {"1,0", "1"}, {"25,4", "25.4"}, {"0,0254", "0.0254"}}) {
    const io::loaded_mesh read = io::load_mesh_noted(file(comma));
    CHECK(read.mesh.vertices == load_mesh(file(point)).vertices);
    REQUIRE(read.notes.size() == 1);
    CHECK(says(read.notes[0], "decimal comma"));
  }
  for (const std::string meter : {"1,000", "0,0", "1,000,000", "1,5.2", ",5", "0,x", "-0,5", "12,345"})
    CHECK(says(sentence([&] { load_mesh(file(meter)); }), "not one finite number"));
}

TEST_CASE("damaged meshes are refused in one sentence that names the file") {
  const robot_folder folder;
  const auto refusal = [&](const std::string& name, const std::string& bytes) {
    const auto file = folder.put(name, bytes);
    const std::string text = sentence([&] { load_mesh(file); });
    INFO(name << ": " << text);
    CHECK(text.starts_with(file.string()));
    CHECK(text.find('\n') == text.npos);
    return text;
  };
  CHECK(says(sentence([&] { load_mesh(folder.path / "none.stl"); }), "there is no such file"));
  for (const char* ending : {"stl", "obj", "ply", "off", "dae", "glb"}) {
    CHECK(says(refusal(std::string("empty.") + ending, ""), "0 bytes"));
    CHECK_FALSE(refusal(std::string("rubbish.") + ending, "rubbish\n").empty());
    CHECK_FALSE(refusal(std::string("zeros.") + ending, std::string(200, '\0')).empty());
  }
  CHECK(says(refusal("a.xyz", "0 0 0\n"), ".obj"));
  CHECK(says(refusal("b.stl", binary_stl(3, 2)), "234 bytes, but it has 184"));
  CHECK(says(refusal("b.stl", binary_stl(0xffffffffu, 2)), "4294967295 triangles"));
  CHECK(says(refusal("b.stl", binary_stl(2, 3)), "has 234"));
  CHECK(says(refusal("b.stl", binary_stl(0, 0)), "no triangles"));
  std::string nan = binary_stl(1, 1);
  const float bad = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(nan.data() + 84 + 16, &bad, 4);
  CHECK(says(refusal("b.stl", nan), "not finite"));
  for (std::size_t cut = 1; cut < ascii_stl.find("endsolid"); cut += 3)
    CHECK_FALSE(refusal("cut.stl", ascii_stl.substr(0, cut)).empty());
  CHECK(says(refusal("n.stl",
                     "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\nvertex 1 0 0\nvertex 0 1 "
                     "0\nendloop\nendfacet\nendsolid"),
             "not finite"));

  CHECK(says(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"), ":4: a face has vertex 4, the file has 3"));
  CHECK(says(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n"), ":4:"));
  CHECK(says(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n"), ":4:"));
  CHECK(says(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n"), "fewer than three"));
  CHECK(says(refusal("a.obj", "v 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), ":1:"));
  for (const std::string rest : {"\n3", " 2\n3", "\nx 3", "\nF 1 2 3"})  // of a face that was broken over two lines
    CHECK(says(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3" + rest + "\n"), "no statement"));
  CHECK(
      load_mesh(folder.put("counts.obj", "3 1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvw 1 0 1\nf 1 2 3\n#x\n")).triangles.size() ==
      1);
  CHECK(says(refusal("a.obj", "v 0 0 inf\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "not finite"));
  CHECK(says(refusal("a.obj", "v 0 0 1.#IND\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "not a number"));
  CHECK(says(refusal("a.obj", "v 0 0 0\n"), "no triangles"));

  CHECK(says(refusal("a.off", "OFF\n999999999999 1 0\n0 0 0\n"), "more than the file holds"));
  CHECK(says(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), "vertex 3"));
  CHECK(says(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n"), "ends before"));
  CHECK(says(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n999999999 0 1 2\n"), "999999999"));

  const std::string head =
      "property float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uint int "
      "vertex_indices\nend_header\n";
  CHECK(says(refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\n" + head + "0 0 0\n"),
             "more than the file holds"));
  CHECK(says(refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n" + head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
             "vertex 3"));
  CHECK(says(
      refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n" + head + "0 0 0\n1 0 0\n0 1 0\n4000000000 0 1\n"),
      "longer than the file"));
  CHECK(says(refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n" + head + "0 0 0\n1 0 0\n0 1 0\n"),
             "more than the file holds"));
  CHECK(says(refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n" + head + "0 0 0\n1 0 0\n"), "cut short"));
  const std::string binary = "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + head +
                             raw_bytes(0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f) + raw_bytes(3, 0, 1, 2);
  CHECK(load_mesh(folder.put("whole.ply", binary)).triangles.size() == 1);
  for (std::size_t cut = 1; cut < binary.size(); cut += 5)
    CHECK_FALSE(refusal("cut.ply", binary.substr(0, cut)).empty());

  CHECK_FALSE(refusal("a.dae", dae("", one_node).substr(0, 700)).empty());
  CHECK(says(refusal("a.dae", dae("", one_node, "99999999999")), "count \"99999999999\""));
  CHECK(says(refusal("a.dae", dae("", one_node, "9", "4")), "more values than its array"));
  CHECK_FALSE(refusal("a.dae", dae("", one_node, "9", "3", "0 1 3")).empty());
  std::string far_input = dae("", one_node);
  far_input.replace(far_input.find("offset=\"0\""), 10, "offset=\"199\"");
  CHECK(says(refusal("a.dae", far_input), "an offset"));
  for (const char* corners : {"0 % 2", "0 &#37; 2", "0 <![CDATA[%]]> 2"})
    CHECK(says(refusal("a.dae", dae("", one_node, "9", "3", corners)), "\"%\" among its numbers"));
  CHECK(says(refusal("a.dae", dae("<unit meter=\"0\"/>", one_node)), "no length"));
  CHECK(says(refusal("a.dae", dae("", "<node id=\"n\"><instance_node url=\"#n\"/></node>")), "inside one another"));
  std::string chain;
  for (int i = 0; i < 8; ++i) {
    chain += "<node id=\"n" + std::to_string(i) + "\">";
    for (int k = 0; k < 10; ++k) chain += "<instance_node url=\"#n" + std::to_string(i + 1) + "\"/>";
    chain += "</node>";
  }
  CHECK(says(refusal("a.dae", dae("", chain + "<node id=\"n8\"><instance_geometry url=\"#g\"/></node>")),
             "mesh_limits::"));
  std::string deep;
  for (int i = 0; i < 50000; ++i) deep += "<node>";
  CHECK(says(refusal("a.dae", dae("", deep)), "inside one another"));
  CHECK(says(refusal("a.glb", raw_bytes(0x46546c67u, 2u, 20u, 0u, 0x4e4f534au) + "x"), "21"));
}

TEST_CASE("of the real damaged files the valid ones load and the others never crash", "[data]") {
  const std::filesystem::path folder = testing::data("/malformed");
  if (!std::filesystem::exists(folder)) {
    WARN("SKIPPED: no folder " << folder);
    return;
  }
  // The rows of SOURCES.md: | `file` | bytes | source | commit | licence | what it is |
  std::ifstream table(folder / "SOURCES.md");
  std::string row;
  int loaded = 0, refused = 0;
  const std::set<std::string> no_mesh = {"points.ply", "emptyIO__stl_empty_bin.stl", "points_emptyface.ply"};
  while (std::getline(table, row)) {
    if (!row.starts_with("| `")) continue;
    const auto file = folder / row.substr(3, row.find('`', 3) - 3);
    const bool valid = says(row, "| VALID");
    const std::string name = file.filename().string();
    const bool points_only = no_mesh.count(name.substr(0, 5) == "PLY__" ? name.substr(5) : name) > 0;
    const std::string text = sentence([&] { load_mesh(file); });
    INFO(file.string() << ": " << text);
    if (valid && !points_only) CHECK(text.empty());
    if (valid && points_only) CHECK(says(text, "no triangles"));
    if (!text.empty()) CHECK(text.starts_with(file.string()));
    ++(text.empty() ? loaded : refused);
  }
  CHECK(loaded >= 50);
  CHECK(refused >= 40);
  for (const char* bad : {"assimp/invalid__OutOfMemory.off", "assimp/invalid__malformed.obj",
                          "assimp/PLY__payload_JVN42386607", "assimp/invalid__box_nested_animation_4286.dae",
                          "microstl/incomplete_binary.stl", "microstl/incomplete_vertex_ascii.stl", "rviz/invalid.stl",
                          "rviz/invalid_short.stl", "rviz/16bit_vs_32bit_should_fail.stl", "tinyobjloader/test-nan.obj",
                          "tinyobjloader/issue-140-zero-face-idx.obj"})
    CHECK_FALSE(sentence([&] { load_mesh(folder / bad); }).empty());
}

}  // namespace mesh_test
