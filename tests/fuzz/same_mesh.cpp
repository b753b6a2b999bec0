// SPDX-License-Identifier: BSD-3-Clause
// One mesh in every format must be the same triangles, or be refused in every one.

#include "fuzz/given.hpp"

#include <clearance/io/mesh.hpp>

#include <optional>

namespace same_mesh_target {

namespace {

using face = std::vector<std::uint32_t>;

struct polygons {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<face> faces;
};

std::string words(const auto& values) {
  std::string made;
  for (const auto value : values) made += (made.empty() ? "" : " ") + fuzz::digits(double(value));
  return made;
}

std::string obj(const polygons& mesh) {
  std::string made;
  for (const auto& v : mesh.vertices) made += "v " + words(v) + '\n';
  for (face f : mesh.faces) {
    for (auto& v : f) ++v;
    made += "f " + words(f) + '\n';
  }
  return made;
}

std::string off(const polygons& mesh) {
  std::string made = "OFF\n" + std::to_string(mesh.vertices.size()) + ' ' + std::to_string(mesh.faces.size()) + " 0\n";
  for (const auto& v : mesh.vertices) made += words(v) + '\n';
  for (const auto& f : mesh.faces) made += std::to_string(f.size()) + ' ' + words(f) + '\n';
  return made;
}

std::string ply(const polygons& mesh, const std::string& format) {
  std::string made = "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                     std::to_string(mesh.faces.size()) + "\nproperty list uchar uint vertex_indices\nend_header\n";
  const bool text = format == "ascii", big = format == "binary_big_endian";
  for (const auto& v : mesh.vertices) {
    if (text) made += words(v) + '\n';
    for (const double c : v) made += text ? "" : fuzz::raw(float(c), big);
  }
  for (const auto& f : mesh.faces) {
    made += text ? std::to_string(f.size()) + ' ' + words(f) + '\n' : fuzz::raw(std::uint8_t(f.size()));
    for (const auto v : f) made += text ? "" : fuzz::raw(v, big);
  }
  return made;
}

std::string dae(const polygons& mesh) {
  std::string values, counts, indices;
  const std::string n = std::to_string(mesh.vertices.size());
  for (const auto& v : mesh.vertices) values += words(v) + ' ';
  for (const auto& f : mesh.faces) counts += std::to_string(f.size()) + ' ', indices += words(f) + ' ';
  return R"(<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="1"/>
<up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="a" count=")" +
         std::to_string(3 * mesh.vertices.size()) + "\">" + values +
         R"(</float_array><technique_common><accessor source="#a" count=")" + n +
         R"(" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count=")" +
         std::to_string(mesh.faces.size()) + R"("><input semantic="VERTEX" source="#v" offset="0"/>
<vcount>)" +
         counts + "</vcount><p>" + indices +
         R"(</p></polylist></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/>
</scene></COLLADA>)";
}

std::string stl(const polygons& mesh, bool text) {
  std::string made = text ? "solid m\n" : std::string(80, ' ') + fuzz::raw(std::uint32_t(mesh.faces.size()));
  for (const auto& f : mesh.faces) {
    made += text ? "facet normal 0 0 0\nouter loop\n" : std::string(12, '\0');
    for (const auto v : f) {
      if (text) made += "vertex " + words(mesh.vertices[v]) + '\n';
      for (const double c : mesh.vertices[v]) made += text ? "" : fuzz::raw(float(c));
    }
    made += text ? "endloop\nendfacet\n" : std::string(2, '\0');
  }
  return made + (text ? "endsolid m\n" : "");
}

std::string glb(const polygons& mesh) {
  std::string places, indices;
  for (const auto& v : mesh.vertices)  // y is up there
    for (const double c : {v.x(), v.z(), -v.y()}) places += fuzz::raw(float(c));
  for (const auto& f : mesh.faces)
    for (const auto v : f) indices += fuzz::raw(v);
  const auto s = [](std::size_t value) { return std::to_string(value); };
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":)" +
      s(mesh.vertices.size()) + R"(,"type":"VEC3"},{"bufferView":1,"componentType":5125,"count":)" +
      s(3 * mesh.faces.size()) + R"(,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":)" + s(places.size()) +
      R"(},{"buffer":0,"byteOffset":)" + s(places.size()) + R"(,"byteLength":)" + s(indices.size()) +
      R"(}],"buffers":[{"byteLength":)" + s(places.size() + indices.size()) + "}]}";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto word = [](std::size_t value) { return fuzz::raw(std::uint32_t(value)); };
  const std::string data = places + indices;
  return "glTF" + word(2) + word(28 + json.size() + data.size()) + word(json.size()) + "JSON" + json +
         word(data.size()) + std::string("BIN\0", 4) + data;
}

using answer = std::optional<std::vector<Eigen::Vector3d>>;

answer read_as(const std::string& name, const std::string& content) {
  fuzz::put(name, content);
  answer found;
  fuzz::reads(name, [&] { found = fuzz::corners(clearance::io::load_mesh(name, fuzz::meshes)); });
  return found;
}

void agree(const answer& first, const std::string& name, const std::string& content) {
  const answer found = read_as(name, content);
  if (first.has_value() != found.has_value())
    fuzz::finding(name + (found ? " is read, m.off is refused: " : " is refused, m.off is read: ") + content);
  if (first && !fuzz::same(*first, *found)) fuzz::finding("another mesh: " + content);
}

void read(std::string_view input) {
  fuzz::given from(input);
  polygons mesh;
  const std::size_t vertices = 3 + from.byte() % 20, faces = 1 + from.byte() % 20;
  const bool stray = from.byte() > 250;  // an index may be that of no vertex
  for (std::size_t i = 0; i < vertices; ++i) {
    const double x = from.coordinate(false), y = from.coordinate(false), z = from.coordinate(false);
    mesh.vertices.emplace_back(x, y, z);
  }
  for (std::size_t i = 0; i < faces; ++i) {
    face f(3 + from.byte() % 4);
    for (auto& v : f) v = std::uint32_t(from.byte() % (vertices + stray));
    mesh.faces.push_back(f);
  }
  const answer first = read_as("m.off", off(mesh));
  agree(first, "m.obj", obj(mesh));
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"})
    agree(first, "m.ply", ply(mesh, format));
  agree(first, "m.dae", dae(mesh));
  if (!first) return;
  polygons halves{*first, {}};  // formats of triangles
  for (std::uint32_t v = 0; v < first->size(); v += 3) halves.faces.push_back({v, v + 1, v + 2});
  agree(first, "m.stl", stl(halves, true));
  agree(first, "m.stl", stl(halves, false));
  agree(first, "m.glb", glb(halves));
}

const fuzz::target same_mesh("same_mesh", read);

}  // namespace

}  // namespace same_mesh_target
